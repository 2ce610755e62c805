#include "live/camera.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

absl::Status within(const char* name, double value, double least, double most) {
  if (std::isfinite(value) && value >= least && value <= most) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(name, " is ", value, ", expected ", least, " to ", most));
}

}  // namespace

double LiveCamera::pixel_rad() const {
  return 2 * std::tan(0.5 * field_of_view_deg * kRadPerDeg) / width_px;
}

ImageSpec LiveCamera::image() const {
  ImageSpec out;
  out.width_px = width_px;
  out.height_px = height_px;
  out.camera = ImageSpec::Camera{field_of_view_deg * kRadPerDeg, look_at_m};
  out.layer = {ImageLayer::kAtSensor};
  return out;
}

absl::Status check_camera(const LiveCamera& c) {
  constexpr double kFarM = 1e6;
  absl::Status out;
  out.Update(within("azimuth_deg", c.azimuth_deg, 0, 360));
  out.Update(within("elevation_deg", c.elevation_deg, -89, 89));
  out.Update(within("range_m", c.range_m, 0.1, kFarM));
  out.Update(within("field_of_view_deg", c.field_of_view_deg, 0.01, 120));
  out.Update(within("look_x_m", c.look_at_m.x, -kFarM, kFarM));
  out.Update(within("look_y_m", c.look_at_m.y, -kFarM, kFarM));
  out.Update(within("look_z_m", c.look_at_m.z, -kFarM, kFarM));
  out.Update(within("width_px", c.width_px, kLeastLivePixels, kMostLiveSide));
  out.Update(within("height_px", c.height_px, kLeastLivePixels, kMostLiveSide));
  if (out.ok() && c.width_px * c.height_px > kMostLivePixels)
    return absl::InvalidArgumentError(absl::StrCat("a picture of ", c.width_px, " x ", c.height_px,
                                                   " pixels, expected at most ", kMostLivePixels));
  return out;
}

absl::StatusOr<Vec<Body>> look_at_of_sweep(const LiveCamera& camera) {
  if (length(camera.look_at_m) < camera.range_m) return camera.look_at_m;
  const Vec<Body> sensor =
      camera.range_m * body_from_aspect(camera.azimuth_deg, camera.elevation_deg);
  const Vec<Body> sight = normalized(camera.look_at_m - sensor);
  const Vec<Body> nearest = sensor - dot(sensor, sight) * sight;
  if (!(dot(sensor, sight) < 0) || !(length(nearest) < camera.range_m))
    return absl::InvalidArgumentError(
        "the camera looks away from the target, expected a middle of the picture that is nearer "
        "to it than the camera: turn the camera");
  return nearest;
}

}  // namespace irsig
