#include "core/signature/view/pixel_background.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/signature/view/prepared_view.h"

namespace irsig {
namespace {

// Integral of the function from the first direction to z.
double integral_to(const BackgroundDirections& directions, const std::vector<double>& value,
                   double z) {
  const auto at = [&](std::uint32_t n) { return static_cast<double>(directions.z(n)); };
  if (z <= at(0)) return (z - at(0)) * value.front();
  double sum = 0;
  std::uint32_t n = 0;
  for (; n + 1 < directions.count() && at(n + 1) <= z; ++n)
    sum += 0.5 * (at(n + 1) - at(n)) * (value[n] + value[n + 1]);
  const double beyond = z - at(n);
  if (n + 1 == directions.count()) return sum + beyond * value[n];
  const double f = beyond / (at(n + 1) - at(n));
  return sum + beyond * (value[n] + 0.5 * f * (value[n + 1] - value[n]));
}

}  // namespace

double mean_between(const BackgroundDirections& directions, const std::vector<double>& value,
                    double from_z, double to_z) {
  // Differences of integrals lose what is far smaller than a pixel.
  constexpr double kLeast = 1e-9;
  if (to_z - from_z < kLeast) {
    const double middle = 0.5 * (from_z + to_z);
    from_z = middle - 0.5 * kLeast;
    to_z = middle + 0.5 * kLeast;
  }
  return (integral_to(directions, value, to_z) - integral_to(directions, value, from_z)) /
         (to_z - from_z);
}

absl::StatusOr<PixelBackground> PixelBackground::make(const PreparedScene& scene,
                                                      const ViewRequest& request,
                                                      const EffectSet& effects,
                                                      const ViewFrame& frame,
                                                      const PictureFrame& pictures) {
  PixelBackground out;
  if (request.land != nullptr) {
    constexpr std::uint32_t kRays = 4;
    ASSIGN_OR_RETURN(auto land,
                     LandBackground::make(scene, request, effects, frame, pictures, kRays, true));
    out.land_.emplace(std::move(land));
    return out;
  }
  const PlaneRectangle& r = pictures.rectangle;
  const double pixel_m = r.width_m / pictures.width_px;
  double least_z = 1, most_z = -1;
  for (std::uint32_t row = 0; row < pictures.height_px; ++row)
    for (std::uint32_t column = 0; column < pictures.width_px; ++column) {
      const double x_m = r.x0_m + (column + 0.5) * pixel_m,
                   y_m = r.y0_m + (pictures.height_px - row) * pixel_m;
      const auto z = [&](double up_m) {
        return normalized(pictures.plane_m * frame.forward + x_m * frame.right + up_m * frame.up).z;
      };
      const auto [upper, lower] = std::minmax({z(y_m), z(y_m - pixel_m)});
      out.upper_z_.push_back(upper);
      out.lower_z_.push_back(lower);
      least_z = std::min(least_z, upper);
      most_z = std::max(most_z, lower);
    }
  std::optional<BackgroundDirections> directions;
  if (request.environment != nullptr) {
    const Viewpoint& v = request.viewpoint;
    const Vec<Body> towards = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
    directions = BackgroundDirections::spanning(
        least_z, most_z, request.environment->horizons_z(request.environment->line(v)),
        std::atan2(-towards.y, -towards.x));
  }
  ASSIGN_OR_RETURN(
      auto surroundings,
      ViewSurroundings::make(request, scene.target, request.viewpoint.range_m, scene.axis.node_um(),
                             directions ? &*directions : nullptr));
  EffectSet without_reflections = effects;
  without_reflections.max_reflections = 0;
  ASSIGN_OR_RETURN(out.environments_,
                   surroundings.evaluate(request.selected_condition, without_reflections));
  return out;
}

std::vector<double> PixelBackground::land_temperature_k(std::span<const double> kelvin) const {
  return land_ ? land_->temperature_k(kelvin) : std::vector<double>(upper_z_.size(), 0.0);
}

PixelBackground::Radiance PixelBackground::of(const Row& row) const {
  if (land_) {
    LandBackground::Radiance seen = land_->of(row.condition, row.on_axis);
    return {std::move(seen.w_m2_sr), std::move(seen.error_w_m2_sr)};
  }
  const ViewEnvironment& e = environments_.condition[row.condition];
  const auto of_directions = [&](const std::vector<ViewEnvironment::Spectrum>& spectra) {
    std::vector<double> out;
    for (const auto& spectrum : spectra) out.push_back(in_band(spectrum, row.on_axis));
    return out;
  };
  const std::vector<double> radiance = of_directions(e.background_apparent),
                            bound = of_directions(e.background_interpolation);
  Radiance out;
  out.bound_w_m2_sr.assign(upper_z_.size(), 0.0);
  for (std::size_t i = 0; i < upper_z_.size(); ++i) {
    out.w_m2_sr.push_back(mean_between(environments_.behind, radiance, upper_z_[i], lower_z_[i]));
    if (!bound.empty())
      out.bound_w_m2_sr[i] = mean_between(environments_.behind, bound, upper_z_[i], lower_z_[i]);
  }
  return out;
}

}  // namespace irsig
