#pragma once

#include <cstdint>
#include <span>

#include "core/thermal/scene/thermal_faces.h"

namespace irsig {

// Irradiance of each face by a sun with one unit of irradiance normal to its beam: the cosine of
// its angle times the fraction of the face that sees the sun, from `points` rays a face to places
// on the sun's disk. 0 below the horizon's plane and for faces below surface_z_m (as
// exchange_factors has it).
struct SunDisk {
  Vec<Body> direction;  // unit vector towards its centre
  double angular_radius_rad;
};
struct SunSettings {
  std::uint32_t points = 4;  // a power of two, at most 16
  std::uint64_t seed = 1;
  double surface_z_m = 0;
};
//   out  [face]
void sun_visibility(const Target& target, const ThermalFaces& faces, const SunDisk& sun,
                    const SunSettings& settings, std::span<float> out);

}  // namespace irsig
