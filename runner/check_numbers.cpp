#include "runner/check_numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace irsig {
namespace {

class Reasons {
 public:
  void add(std::string reason) { reasons_.push_back(std::move(reason)); }
  void see(const std::string& name, double value, double least) {
    if (!std::isfinite(value)) add(absl::StrCat(name, " is not a finite number: ", value));
    if (value < least) add(absl::StrCat(name, " is negative: ", value));
  }
  // error: how far below 0 an estimate of something positive may lie.
  void see(const std::string& name, const Estimate& e, double error) {
    see(name, e.value, -error);
    see(name + "'s standard error", e.stderr_, 0);
  }
  template <typename Number>
  void see_all(const std::string& name, const std::vector<Number>& values, bool signed_values) {
    const auto wrong = std::find_if(values.begin(), values.end(), [&](Number v) {
      return !std::isfinite(v) || (v < 0 && !signed_values);
    });
    if (wrong != values.end())
      add(absl::StrCat(name, "[", wrong - values.begin(), "] is ", static_cast<double>(*wrong)));
  }
  void see_guards(const std::string& of, std::uint64_t nonfinite, std::uint64_t negative) {
    if (nonfinite > 0)
      add(absl::StrCat(of, nonfinite, " path weights were not finite (guarded_nonfinite)"));
    if (negative > 0)
      add(absl::StrCat(of, negative, " path weights were negative (guarded_negative)"));
  }
  // The blackbody's temperature for this radiance.
  void see_temperature(const std::string& name, double temperature_k, double radiance_w_m2_sr) {
    if (std::isnan(temperature_k))
      add(absl::StrCat(name, " is not a finite number: no blackbody has a radiance of ",
                       radiance_w_m2_sr, " W/(m2 sr)"));
    else
      see(name, temperature_k, 0);
  }
  [[nodiscard]] absl::Status status() const {
    if (reasons_.empty()) return absl::OkStatus();
    return absl::InternalError(
        absl::StrCat("the result cannot be trusted: ", absl::StrJoin(reasons_, "; ")));
  }

 private:
  std::vector<std::string> reasons_;
};

// Contrast has any sign. Of transmittance, a mean of numbers up to 1 may exceed it by rounding.
void see_aperture(const std::string& row, const SignatureResult& r, Reasons& reasons) {
  constexpr double kAnySign = std::numeric_limits<double>::infinity();
  reasons.see(row + "contrast_intensity_w_sr", r.contrast_intensity_w_sr, kAnySign);
  reasons.see(row + "contrast_numerical_error_w_sr", r.contrast_numerical_error_w_sr, 0);
  reasons.see(row + "background_radiance_w_m2_sr", r.background_radiance_w_m2_sr, 0);
  reasons.see(row + "direction_interpolation_bound_w_sr", r.direction_interpolation_bound_w_sr, 0);
  reasons.see(row + "model_error_w_sr", r.model_error_w_sr, 0);
  reasons.see(row + "apparent_model_error_w_sr", r.apparent_model_error_w_sr, 0);
  reasons.see(row + "contrast_model_error_w_sr", r.contrast_model_error_w_sr, 0);
  reasons.see(row + "background_bound_w_sr", r.background_bound_w_sr, 0);
  reasons.see(row + "path_transmittance", r.path_transmittance, 0);
  reasons.see(row + "path_radiance_w_m2_sr", r.path_radiance_w_m2_sr, 0);
  constexpr double kMost = 1 + 1e-9;
  if (r.path_transmittance > kMost)
    reasons.add(absl::StrCat(row, "path_transmittance is above 1: ", r.path_transmittance));
  if (!r.path_transmittance_spectral.empty() &&
      *std::max_element(r.path_transmittance_spectral.begin(),
                        r.path_transmittance_spectral.end()) > kMost)
    reasons.add(row + "path_transmittance is above 1 at a wavelength");
  reasons.see_all(row + "path_transmittance", r.path_transmittance_spectral, false);
  reasons.see_all(row + "path_radiance_w_m2_sr_um", r.path_radiance_spectral, false);
  reasons.see_all(row + "contrast_spectral_intensity_w_sr_um", r.contrast_spectral.value, true);
  reasons.see_all(row + "contrast_spectral_intensity_stderr_w_sr_um", r.contrast_spectral.stderr_,
                  false);
  reasons.see_all(row + "background_radiance_w_m2_sr_um", r.background_spectral.value, true);
  reasons.see_all(row + "background_radiance_stderr_w_m2_sr_um", r.background_spectral.stderr_,
                  false);
}

// Checks the omitted bounds and the undersampling errors. In a ledger, NaN stands for "not known".
void see_omitted(const std::string& row, const SignatureResult& r, Reasons& reasons) {
  struct Error {
    const char* of;
    double omitted_w_sr, unseen_w_sr, stderr_w_sr, numerical_error_w_sr;
  };
  for (const Error& e :
       {Error{"", r.omitted_bound_w_sr, r.undersampling_stderr_w_sr, r.intensity_w_sr.stderr_,
              r.numerical_error_w_sr},
        Error{"apparent_", r.apparent_omitted_bound_w_sr, r.apparent_undersampling_stderr_w_sr,
              r.apparent_intensity_w_sr.stderr_, r.apparent_numerical_error_w_sr},
        Error{"contrast_", r.contrast_omitted_bound_w_sr, r.contrast_undersampling_stderr_w_sr,
              r.contrast_intensity_w_sr.stderr_, r.contrast_numerical_error_w_sr}}) {
    const std::string omitted = absl::StrCat(e.of, "omitted_bound_w_sr"),
                      unseen = absl::StrCat(e.of, "undersampling_stderr_w_sr");
    reasons.see(row + omitted, e.omitted_w_sr, 0);
    reasons.see(row + unseen, e.unseen_w_sr, 0);
    if (numerical_error(e.stderr_w_sr, e.unseen_w_sr, e.omitted_w_sr) >
        (1 + 1e-9) * e.numerical_error_w_sr)
      reasons.add(absl::StrCat(row, omitted, " or ", unseen,
                               " is no part of the numerical error: ", e.omitted_w_sr, ", ",
                               e.unseen_w_sr, " in ", e.numerical_error_w_sr));
  }
  reasons.see(row + "absolute_floor_w_sr", r.absolute_floor_w_sr, 0);
  reasons.see(row + "backface_fraction", r.backface_fraction, 0);
  reasons.see(row + "temperature_bound_w_sr", r.temperature_bound_w_sr, 0);
  reasons.see(row + "apparent_temperature_bound_w_sr", r.apparent_temperature_bound_w_sr, 0);
  constexpr double kAnySign = std::numeric_limits<double>::infinity();
  for (const LedgerEntry& e : r.effect) {
    const auto known = [&](const char* name, double value, double least) {
      if (!std::isnan(value))
        reasons.see(absl::StrCat(row, std::string(info_of(e.effect).name), "'s ", name), value,
                    least);
    };
    known("bound_w_sr", e.bound_w_sr, 0);
    known("apparent_bound_w_sr", e.apparent_bound_w_sr, 0);
    known("contrast_bound_w_sr", e.contrast_bound_w_sr, 0);
    known("fraction_w_sr", e.fraction_w_sr, -kAnySign);
    known("time_s", e.time_s, 0);
  }
  // A material that creates energy absorbs less than nothing.
  if (std::isnan(r.energy.balance.value)) return;
  reasons.see(row + "energy.absorbed", r.energy.absorbed, kAnySign);
  reasons.see(row + "energy.escaped_to_sky", r.energy.escaped_to_sky, 0);
  reasons.see(row + "energy.escaped_to_surface", r.energy.escaped_to_surface, 0);
  reasons.see(row + "energy.cut_off", r.energy.cut_off, 0);
  reasons.see(row + "energy.balance", r.energy.balance, kAnySign);
}

void check_row(const SignatureResult& r, Reasons& reasons) {
  const std::string row = absl::StrCat("condition ", r.condition, ", band ", r.band, ": ");
  const double error = r.numerical_error_w_sr;
  reasons.see(row + "numerical_error_w_sr", error, 0);
  reasons.see(row + "intensity_w_sr", r.intensity_w_sr, error);
  reasons.see(row + "apparent_intensity_w_sr", r.apparent_intensity_w_sr,
              r.apparent_numerical_error_w_sr);
  reasons.see(row + "projected_area_m2", r.projected_area_m2, 0);
  see_aperture(row, r, reasons);
  see_omitted(row, r, reasons);
  reasons.see_temperature(row + "source_radiance_temperature_k", r.source_radiance_temperature_k,
                          r.intensity_w_sr.value / r.projected_area_m2.value);
  reasons.see_temperature(row + "apparent_temperature_k", r.apparent_temperature_k,
                          r.apparent_intensity_w_sr.value / r.projected_area_m2.value);
  for (std::size_t c = 0; c < kCauses; ++c) {
    reasons.see(absl::StrCat(row, "cause ", c), r.cause_w_sr[c], error);
    reasons.see_all(absl::StrCat(row, "spectrum of cause ", c), r.spectral_cause[c].value, true);
  }
  for (std::size_t p = 0; p < r.part_w_sr.size(); ++p)
    reasons.see(absl::StrCat(row, "part ", p), r.part_w_sr[p], error);
  // Single wavelengths may lie below 0 by the error of a spectral basis.
  reasons.see_all(row + "spectral_intensity_w_sr_um", r.spectral.value, true);
  reasons.see_all(row + "spectral_intensity_stderr_w_sr_um", r.spectral.stderr_, false);
  reasons.see_all(row + "apparent_spectral_intensity_w_sr_um", r.apparent_spectral.value, true);
  reasons.see_all(row + "image_w_m2_sr", r.image_w_m2_sr, true);
  reasons.see_all(row + "image_stderr_w_m2_sr", r.image_stderr_w_m2_sr, false);
}

}  // namespace

absl::Status check_numbers(const ViewResult& view) {
  Reasons reasons;
  reasons.see_guards("", view.guarded_nonfinite, view.guarded_negative);
  for (const SignatureResult& r : view.row) check_row(r, reasons);
  return reasons.status();
}

absl::Status check_numbers(const std::string& name, const ProfileResult& profile) {
  Reasons reasons;
  reasons.see_guards(name + ": ", profile.counts.guarded_nonfinite,
                     profile.counts.guarded_negative);
  for (const ProfileRow& r : profile.row) {
    const std::string row = absl::StrCat(name, ": point ", r.point, ", condition ", r.condition,
                                         ", band ", r.band, ", reflections ", r.reflections, ": ");
    // Sums of weights and sources that are not negative: no error makes them so.
    reasons.see(row + "radiance_w_m2_sr", r.radiance_w_m2_sr, 0);
    reasons.see(row + "apparent_radiance_w_m2_sr", r.apparent_radiance_w_m2_sr, 0);
    reasons.see(row + "truncation_bound_w_m2_sr", r.truncation_bound_w_m2_sr, 0);
    reasons.see(row + "quadrature_bound_w_m2_sr", r.quadrature_bound_w_m2_sr, 0);
    reasons.see(row + "target_fraction", r.target_fraction, 0);
    const std::string temperature = row + "source_radiance_temperature_k";
    reasons.see_temperature(temperature, r.source_radiance_temperature_k.value,
                            r.radiance_w_m2_sr.value);
    if (!std::isnan(r.source_radiance_temperature_k.value))
      reasons.see(temperature + "'s standard error", r.source_radiance_temperature_k.stderr_, 0);
  }
  return reasons.status();
}

}  // namespace irsig
