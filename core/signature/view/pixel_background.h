#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "core/environment/background_directions.h"
#include "core/signature/view/land_background.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"
#include "core/signature/view/row.h"
#include "core/signature/view/view_pictures.h"
#include "core/sources/view_sources.h"

namespace irsig {

// PixelBackground is what a sensor sees beside the target in the pixels of its pictures: sky, sea
// or ground, with the horizon between them; or land. But for land radiance depends on the elevation
// alone, along the azimuth of the view: what changes to the left and right of it within the picture
// is not seen.
class PixelBackground {
 public:
  // Computes the background of each pixel. INVALID_ARGUMENT as in Environment::view().
  [[nodiscard]] static absl::StatusOr<PixelBackground> make(const PreparedScene& scene,
                                                            const ViewRequest& request,
                                                            const EffectSet& effects,
                                                            const ViewFrame& frame,
                                                            const PictureFrame& pictures);

  // [pixel], row by row from the top left, of one of the selected conditions: in-band radiance,
  // mean over the pixel, without that of the path; and the bound of its interpolation between
  // directions, or of land its error. [W/(m2 sr)]
  struct Radiance {
    std::vector<double> w_m2_sr, bound_w_m2_sr;
  };
  [[nodiscard]] Radiance of(const Row& row) const;
  // Requires land.
  [[nodiscard]] LandBackground::Parts land_parts_of(const Row& row) const {
    return land_->parts_of(row.condition, row.on_axis);
  }
  // Returns LandBackground::temperature_k, or 0 without land.
  [[nodiscard]] std::vector<double> land_temperature_k(std::span<const double> kelvin) const;

 private:
  std::optional<LandBackground> land_;
  ViewEnvironments environments_;
  std::vector<double> upper_z_, lower_z_;  // [pixel] directions of its upper and lower side
};

// Returns the mean over [from_z, to_z] of a function that is linear between the directions.
//   value  [direction]
[[nodiscard]] double mean_between(const BackgroundDirections& directions,
                                  const std::vector<double>& value, double from_z, double to_z);

}  // namespace irsig
