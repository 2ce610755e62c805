#include "core/imager/imager.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

using std::numbers::pi;

constexpr std::uint32_t kMostSidePx = 4096;

template <typename Value>
double in_band(const BandGrid& grid, Value&& value) {
  double sum = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    sum += grid.band_weight[i] * value(grid.node_um[i]);
  return sum;
}

// Standard normal number `index` of a seed, by Box and Muller's transform [boxmuller1958].
double normal(std::uint64_t seed, std::uint64_t index) {
  const std::uint64_t a = mix64(seed ^ mix64(index)), b = mix64(a);
  const auto unit = [](std::uint64_t bits) {
    return (static_cast<double>(bits >> 11U) + 0.5) * 0x1p-53;
  };
  return std::sqrt(-2 * std::log(unit(a))) * std::cos(2 * pi * unit(b));
}

std::uint32_t pixels_over(double stored_px, double ratio, std::uint32_t margin_px) {
  // A whole number of pixels stays one in spite of rounding.
  return static_cast<std::uint32_t>(std::max(1.0, std::ceil(stored_px / ratio - 1e-9))) +
         2 * margin_px;
}

}  // namespace

double Imager::full_scale_counts() const { return std::ldexp(1.0, static_cast<int>(bits)) - 1; }

absl::StatusOr<ImagerInBand> imager_in_band(const Imager& imager, const Band& band) {
  ASSIGN_OR_RETURN(const auto grid, make_band_grid(band));
  const auto radiance = [&](double kelvin) {
    return in_band(grid, [&](double um) { return planck_radiance_w_m2_sr_um(um, kelvin); });
  };
  const double scene_k = imager.scene_temperature_k;
  const double per_k = in_band(
      grid, [&](double um) { return planck_radiance_derivative_w_m2_sr_um_k(um, scene_k); });
  ImagerInBand out{};
  out.wavelength_um =
      in_band(grid, [&](double um) { return um * planck_radiance_w_m2_sr_um(um, scene_k); }) /
      radiance(scene_k);
  out.noise_w_m2_sr = imager.netd_k * per_k;
  out.fixed_pattern_w_m2_sr = imager.fixed_pattern_k * per_k;
  if (const auto* stated = std::get_if<CountsOfRadiance>(&imager.gain)) {
    out.counts_per_w_m2_sr = stated->counts_per_w_m2_sr;
    out.offset_counts = stated->offset_counts;
  } else {
    const auto& ends = std::get<CountsOfTemperatures>(imager.gain);
    const double black = radiance(ends.black_k);
    out.counts_per_w_m2_sr = imager.full_scale_counts() / (radiance(ends.white_k) - black);
    out.offset_counts = -black * out.counts_per_w_m2_sr;
  }
  if (!std::isfinite(out.wavelength_um) || !std::isfinite(out.counts_per_w_m2_sr) ||
      !std::isfinite(out.offset_counts))
    return absl::InvalidArgumentError(
        absl::StrCat("band ", band.name, ": blackbodies of the imager's temperatures have no ",
                     "radiance there that gives a finite gain"));
  return out;
}

double optics_mtf(const Imager& imager, double wavelength_um, double f) {
  const double n = 1e-6 * wavelength_um * f / imager.aperture_m;
  if (n >= 1) return 0;
  const double phase = pi * imager.jitter_rad * f;
  return 2 / pi * (std::acos(n) - n * std::sqrt(1 - n * n)) * std::exp(-2 * phase * phase);
}

double pixel_mtf(const Imager& imager, double f) {
  const double x = std::sqrt(imager.fill_factor) * imager.ifov_rad() * f;
  return x == 0 ? 1 : std::sin(pi * x) / (pi * x);
}

absl::StatusOr<DetectorGrid> detector_grid(const Imager& imager, std::uint32_t width_px,
                                           std::uint32_t height_px, double pixel_rad) {
  const double ratio = imager.ifov_rad() / pixel_rad;
  const double longest_px = std::max(width_px, height_px);
  // Stored angles are rounded.
  if (!(ratio >= 2 * (1 - 1e-9)))
    return absl::InvalidArgumentError(absl::StrCat(
        "its pixels of ", 1e6 * pixel_rad, " urad are wider than half of the imager's ",
        1e6 * imager.ifov_rad(), " urad, so that its sharpness is unknown; run the sweep with ",
        "[output] thumbnail_px = ", std::ceil(2 * longest_px / ratio),
        " or more, or with as many [image] pixels"));
  if (longest_px / ratio + 2 * imager.margin_px > kMostSidePx)
    return absl::InvalidArgumentError(
        absl::StrCat("the imager needs more than ", kMostSidePx, " pixels along a side for it"));
  DetectorGrid out{};
  out.ratio = ratio;
  out.width_px = pixels_over(width_px, ratio, imager.margin_px);
  out.height_px = pixels_over(height_px, ratio, imager.margin_px);
  out.left = 0.5 * (width_px - ratio * out.width_px);
  out.top = 0.5 * (height_px - ratio * out.height_px);
  return out;
}

CountsImage counts_image(const Imager& imager, const ImagerInBand& figures,
                         const RadianceImage& radiance, std::uint64_t frame) {
  const std::uint64_t pattern_seed = mix64(~imager.seed);
  const std::uint64_t noise_seed = mix64(imager.seed ^ mix64(frame));
  const double full_scale = imager.full_scale_counts();
  CountsImage out{radiance.width_px, radiance.height_px, {}, 0};
  out.counts.reserve(radiance.radiance_w_m2_sr.size());
  for (std::uint32_t y = 0; y < radiance.height_px; ++y)
    for (std::uint32_t x = 0; x < radiance.width_px; ++x) {
      const std::uint64_t place = std::uint64_t{y} << 32U | x;
      const auto received =
          static_cast<double>(radiance.radiance_w_m2_sr[std::size_t{y} * radiance.width_px + x]);
      const double noisy = received + figures.fixed_pattern_w_m2_sr * normal(pattern_seed, place) +
                           figures.noise_w_m2_sr * normal(noise_seed, place);
      const double counts = std::round(figures.counts_per_w_m2_sr * noisy + figures.offset_counts);
      if (counts < 0 || counts > full_scale) ++out.saturated_px;
      out.counts.push_back(static_cast<std::uint16_t>(std::clamp(counts, 0.0, full_scale)));
    }
  return out;
}

}  // namespace irsig
