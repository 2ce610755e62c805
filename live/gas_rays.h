#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/signature/view/view_pictures.h"
#include "core/transport/primary_rays.h"
#include "live/live_gas.h"

namespace irsig {

// Hot gas of one frame. Rays through corners of pixels are marched through the field, first every
// kPitch pixels, then at half that distance where neighbours differ most or miss gas that lies
// between them, down to every corner. Pixels interpolate between the four rays around them.
class GasRays {
 public:
  // Pixels between the first rays.
  static constexpr std::uint32_t kPitch = 8;
  // The table, the weights and the frames outlive this.
  //   centre         of the target
  //   light_w_m2_sr  typical light of the frame without gas
  GasRays(const LiveGas& table, const std::vector<float>& weights, Vec<Body> centre,
          const ViewFrame& frame, const PictureFrame& pictures, float light_w_m2_sr);

  // Chooses rays, `pitch` pixels apart, and returns the number of groups of them. Each pitch is
  // chosen once all groups of the one before, which is twice as large, were traced.
  [[nodiscard]] std::uint32_t choose(std::uint32_t pitch);
  // Marches the rays of a group. Any thread may do so.
  void trace_group(std::uint32_t group);

  // Gas before what a pixel shows.
  struct Seen {
    GasOnRay light;
    // Half the range that holds nine pixels in ten, of the emission and of each absorption.
    GasOnRay error;
  };
  // Returns false if there is no gas.
  //   x_px, y_px  place in the picture, from its top left
  //   range_m     of what the ray meets; 0: nothing
  [[nodiscard]] bool at(double x_px, double y_px, double range_m, Seen& out) const;
  // Flags the pixels that hold gas which none of the rays around them meets.
  //   edge  [pixel], row by row from the top left
  void flag_missed(std::vector<std::uint8_t>& edge) const;

 private:
  struct Ray {
    GasOnRay light;
    float near_m = 0, far_m = 0;  // ends of the gas; equal: there is none
  };
  // A square of pixels between four rays, by its top left corner.
  struct Cell {
    float range_w_m2_sr;  // of the emission of its rays; infinite: they miss gas between them
    std::uint32_t x, y;
  };
  // Marks the cells of kPitch between whose rays the field's points are seen.
  void find_cells();
  [[nodiscard]] std::vector<Cell> cells_to_halve(std::uint32_t side) const;
  // Adds a cell's rays that are not there yet.
  void add_cell(std::uint32_t x, std::uint32_t y, std::uint32_t side, std::uint32_t pitch);
  // Returns true if a point of the field in the cell is at least as bright.
  [[nodiscard]] bool holds(std::uint32_t x, std::uint32_t y, std::uint32_t side,
                           std::uint8_t least) const;
  // Returns true if gas lies between rays that all miss it.
  [[nodiscard]] bool misses_gas(std::uint32_t x, std::uint32_t y, std::uint32_t side) const;
  [[nodiscard]] std::uint32_t side_at(std::uint32_t x, std::uint32_t y) const;
  [[nodiscard]] std::array<const Ray*, 4> rays_of(std::uint32_t x, std::uint32_t y,
                                                  std::uint32_t side) const;
  [[nodiscard]] Ray march_ray(double x_px, double y_px) const;

  const LiveGas& table_;
  const std::vector<float>& weights_;
  Vec<Body> centre_;
  const ViewFrame& frame_;
  const PictureFrame& pictures_;
  double pixel_m_;
  float refined_w_m2_sr_;             // least range of a cell that is halved
  std::uint32_t width_, height_;      // multiples of kPitch
  std::vector<std::uint8_t> pitch_;   // [row][column] of the smallest cell there; 0: no gas
  std::vector<std::uint8_t> point_;   // [row][column] brightness of points there; 0: none
  std::vector<std::int32_t> ray_at_;  // [row][column of corners] place in ray_; -1: none
  struct Place {
    std::uint32_t x, y;
  };
  std::vector<Place> place_;  // [ray]
  std::vector<Ray> ray_;
  std::size_t traced_ = 0;  // rays of earlier calls of choose()
};

}  // namespace irsig
