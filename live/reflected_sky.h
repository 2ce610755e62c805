#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/environment/fit/direction_nodes.h"
#include "core/signature/view/prepared_scene.h"

namespace irsig {

// Light from the surroundings that a surface reflects, prefiltered by its BRDF: by the tilt of the
// surface, by the viewing angle, and by the azimuth of the sensor around its normal. The light
// depends on the elevation alone; rings with azimuths are replaced by their mean. Directions are
// drawn by the material, equal for all light.
class ReflectedSky {
 public:
  static constexpr std::uint32_t kTilts = 13;    // of the normal from the zenith: 0 .. 180 deg
  static constexpr std::uint32_t kAzimuths = 7;  // of the sensor from uphill: 0 .. 180 deg
  static constexpr std::uint32_t kCosines = 9;   // linear in the square root of the cosine
  static constexpr std::uint32_t kEntries = kTilts * kAzimuths * kCosines;
  static constexpr std::uint32_t kDirections = 64;  // of each entry

  ReflectedSky(const PreparedScene& scene, const DirectionNodes& nodes);

  [[nodiscard]] std::uint32_t rings() const { return rings_; }

  // Returns the reflected radiance of each entry of a material, [kEntries].
  //   ring  [ring][column] radiance of the rings, in-band in the order of the columns of paths
  [[nodiscard]] std::vector<float> of(std::uint32_t material, std::span<const double> ring,
                                      std::size_t first_column, std::size_t columns) const;

  // Interpolates in a table of of().
  //   up       z of the normal, upwards
  //   cos_o    of the angle at which the surface is seen, 0 .. 1
  //   azimuth  of the sensor around the normal, from uphill [rad], 0 .. pi
  [[nodiscard]] static float look_up(const float* table, float up, float cos_o, float azimuth);

 private:
  struct Direction {
    std::uint32_t ring[2];
    float weight[2];
  };
  struct Filter {
    std::vector<Direction> direction;  // [entry][kDirections]
    std::vector<float> column;         // [entry][kDirections][column of the material]
  };
  std::uint32_t rings_, azimuths_;
  std::size_t columns_;  // of the materials: 1, or as many as paths carry
  std::vector<Filter> material_;
};

}  // namespace irsig
