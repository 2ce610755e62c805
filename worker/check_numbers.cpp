#include "worker/check_numbers.h"

#include <algorithm>
#include <cmath>
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
    if (!std::isfinite(value)) add(absl::StrCat(name, " is not a finite number"));
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
  [[nodiscard]] absl::Status status() const {
    if (reasons_.empty()) return absl::OkStatus();
    return absl::InternalError(
        absl::StrCat("the result cannot be trusted: ", absl::StrJoin(reasons_, "; ")));
  }

 private:
  std::vector<std::string> reasons_;
};

void check_row(const SignatureResult& r, Reasons& reasons) {
  const std::string row = absl::StrCat("condition ", r.condition, ", band ", r.band, ": ");
  const double error = r.numerical_error_w_sr;
  reasons.see(row + "numerical_error_w_sr", error, 0);
  reasons.see(row + "intensity_w_sr", r.intensity_w_sr, error);
  reasons.see(row + "apparent_intensity_w_sr", r.apparent_intensity_w_sr,
              r.apparent_numerical_error_w_sr);
  reasons.see(row + "projected_area_m2", r.projected_area_m2, 0);
  reasons.see(row + "apparent_temperature_k", r.apparent_temperature_k, 0);
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
}

}  // namespace

absl::Status check_numbers(const ViewResult& view) {
  Reasons reasons;
  if (view.guarded_nonfinite > 0)
    reasons.add(
        absl::StrCat(view.guarded_nonfinite, " path weights were not finite (guarded_nonfinite)"));
  if (view.guarded_negative > 0)
    reasons.add(
        absl::StrCat(view.guarded_negative, " path weights were negative (guarded_negative)"));
  for (const SignatureResult& r : view.row) check_row(r, reasons);
  return reasons.status();
}

}  // namespace irsig
