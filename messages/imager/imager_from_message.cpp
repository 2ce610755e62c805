#include "messages/imager/imager_from_message.h"

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr std::uint32_t kMostMarginPx = 256;

absl::Status within(const char* key, double value, double least, double most) {
  if (value >= least && value <= most) return absl::OkStatus();
  return keyed_problem(key, absl::StrCat("= ", value, ", expected ", least, " to ", most));
}

absl::Status check_finite(const Imager& imager) {
  RETURN_IF_ERROR(within("imager.optics.aperture_m", imager.aperture_m, 1e-5, 100));
  RETURN_IF_ERROR(within("imager.optics.f_number", imager.f_number, 0.1, 1e3));
  RETURN_IF_ERROR(within("imager.optics.jitter_rad", imager.jitter_rad, 0, 0.1));
  RETURN_IF_ERROR(within("imager.detector.pitch_m", imager.pitch_m, 1e-7, 1));
  RETURN_IF_ERROR(within("imager.detector.fill_factor", imager.fill_factor, 0.01, 1));
  RETURN_IF_ERROR(within("imager.detector.netd_k", imager.netd_k, 0, 1e3));
  RETURN_IF_ERROR(
      within("imager.detector.scene_temperature_k", imager.scene_temperature_k, 100, 20000));
  RETURN_IF_ERROR(within("imager.detector.fixed_pattern_k", imager.fixed_pattern_k, 0, 1e3));
  RETURN_IF_ERROR(within("imager.detector.margin_px", imager.margin_px, 0, kMostMarginPx));
  if (imager.bits != 8 && imager.bits != 14 && imager.bits != 16)
    return keyed_problem("imager.counts.bits",
                         absl::StrCat("= ", imager.bits, ", expected 8, 14 or 16"));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Imager> imager_from_message(const schema::ImagerFile& stated) {
  const schema::ImagerDetector& d = stated.detector();
  const schema::ImagerCounts& c = stated.counts();
  Imager out;
  out.aperture_m = stated.optics().aperture_m();
  out.f_number = stated.optics().f_number();
  out.jitter_rad = stated.optics().jitter_rad();
  out.pitch_m = d.pitch_m();
  out.netd_k = d.netd_k();
  out.fixed_pattern_k = d.fixed_pattern_k();
  if (d.has_fill_factor()) out.fill_factor = d.fill_factor();
  if (d.has_scene_temperature_k()) out.scene_temperature_k = d.scene_temperature_k();
  if (d.has_margin_px()) out.margin_px = d.margin_px();
  if (d.has_seed()) out.seed = d.seed();
  out.bits = c.bits();
  RETURN_IF_ERROR(check_finite(out));
  if (c.has_black_k() && c.has_white_k() && c.black_k() >= 0 && c.white_k() > c.black_k() &&
      std::isfinite(c.white_k()))
    out.gain = CountsOfTemperatures{c.black_k(), c.white_k()};
  else if (c.counts_per_w_m2_sr() > 0 && std::isfinite(c.counts_per_w_m2_sr()) &&
           std::isfinite(c.offset_counts()))
    out.gain = CountsOfRadiance{c.counts_per_w_m2_sr(), c.offset_counts()};
  else
    return keyed_problem("imager.counts",
                         "states no gain, expected black_k and white_k, or counts_per_w_m2_sr and "
                         "offset_counts");
  return out;
}

}  // namespace irsig
