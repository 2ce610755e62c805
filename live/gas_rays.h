#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/signature/view/view_pictures.h"
#include "core/transport/primary_rays.h"
#include "live/live_gas.h"

namespace irsig {

// Hot gas of one frame: a ray through every fourth corner of pixels is marched through the field,
// and pixels interpolate between the four rays around them. Where these differ most, rays go
// through every corner of pixels.
class GasRays {
 public:
  // Pixels between rays.
  static constexpr std::uint32_t kPitch = 4;
  // The table, the weights and the frames outlive this.
  //   centre  of the target
  GasRays(const LiveGas& table, const std::vector<float>& weights, Vec<Body> centre,
          const ViewFrame& frame, const PictureFrame& pictures);

  // Returns the number of rows of rays. Any thread may trace a row; all are traced before refine()
  // is called.
  [[nodiscard]] std::uint32_t rows() const { return down_; }
  // Marches the rays of a row that pass near gas.
  void trace_row(std::uint32_t row);
  // Chooses the blocks of kPitch x kPitch pixels that get rays of their own, and returns their
  // number. Any thread may trace a block; all are traced before at() is called.
  //   light_w_m2_sr  typical light of the frame without gas
  [[nodiscard]] std::uint32_t refine(float light_w_m2_sr);
  void trace_block(std::uint32_t n);

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

 private:
  struct Ray {
    GasOnRay light;
    float near_m = 0, far_m = 0;  // ends of the gas; equal: there is none
  };
  static constexpr std::uint32_t kAlong = kPitch + 1, kOfBlock = kAlong * kAlong;  // fine rays
  struct Corners {
    std::array<const Ray*, 4> ray;  // top left, top right, bottom left, bottom right
    float u, v;                     // place between them
  };
  [[nodiscard]] Corners corners_at(double x_px, double y_px) const;
  // Marks the blocks between rays in which a field's points are seen.
  void find_blocks(const PlumeField& field);
  [[nodiscard]] bool is_wanted(std::uint32_t column, std::uint32_t row) const;
  [[nodiscard]] Ray march_ray(double x_px, double y_px) const;

  const LiveGas& table_;
  const std::vector<float>& weights_;
  Vec<Body> centre_;
  const ViewFrame& frame_;
  const PictureFrame& pictures_;
  double pixel_m_;
  std::uint32_t across_, down_;         // rays
  std::vector<std::uint8_t> block_;     // [row][column] 1: gas may be seen there
  std::vector<Ray> ray_;                // [row][column]
  std::vector<std::uint32_t> refined_;  // blocks
  std::vector<std::int32_t> fine_of_;   // [block] place in refined_; -1: it has no fine rays
  std::vector<Ray> fine_;               // [place in refined_][row][column]
};

}  // namespace irsig
