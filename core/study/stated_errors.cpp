#include "core/study/stated_errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

double in_errors(double difference, double rounding, double error) {
  const double beyond = std::max(std::abs(difference) - rounding, 0.0);
  if (beyond == 0) return 0;
  return error > 0 ? beyond / error : std::numeric_limits<double>::infinity();
}

void take(const Estimate& reference, StatedValue& value) {
  value.reference = reference.value;
  value.reference_stderr = reference.stderr_;
}

absl::Status add_stated_reference(const SignatureResult& reference, StatedRow& row) {
  if (reference.reflections != row.reflections)
    return absl::FailedPreconditionError(
        absl::StrCat("the rows were computed with up to ", row.reflections,
                     " reflections, and this program would give them ", reference.reflections,
                     ": another version made them"));
  take(reference.intensity_w_sr, row.in_band[static_cast<std::size_t>(Stated::kIntensity)]);
  take(reference.apparent_intensity_w_sr, row.in_band[static_cast<std::size_t>(Stated::kApparent)]);
  take(reference.contrast_intensity_w_sr, row.in_band[static_cast<std::size_t>(Stated::kContrast)]);
  take(reference.projected_area_m2, row.in_band[static_cast<std::size_t>(Stated::kArea)]);
  if (row.spectrum.size() != reference.spectral.value.size())
    return absl::FailedPreconditionError(absl::StrCat("a row has ", row.spectrum.size(),
                                                      " stored wavelengths, expected ",
                                                      reference.spectral.value.size()));
  for (std::size_t k = 0; k < row.spectrum.size(); ++k)
    take({reference.spectral.value[k], reference.spectral.stderr_[k]}, row.spectrum[k]);
  return absl::OkStatus();
}

}  // namespace

double StatedValue::of_stderr() const { return in_errors(value - reference, rounding, stderr_); }

double StatedValue::of_numerical_error() const {
  return in_errors(value - reference, rounding, numerical_error);
}

absl::StatusOr<CheckedErrors> check_stated_errors(const Simulator& simulator, ViewRequest request,
                                                  std::vector<StatedRow> rows,
                                                  const LongerRun& longer) {
  request.thumbnail_px = 0;
  ASSIGN_OR_RETURN(auto planned, simulator.prepare(request));
  std::uint64_t& samples_per_replicate = planned.plan.samples_per_replicate;
  if (longer.row_samples > 0) samples_per_replicate = longer.row_samples;
  const auto own = static_cast<double>(samples_per_replicate);
  const double samples =
      std::min(std::ceil(longer.times * own), static_cast<double>(longer.most_samples));
  samples_per_replicate = static_cast<std::uint64_t>(samples);
  request.seed += longer.seed_offset;
  request.selected_condition.clear();
  request.selected_band.clear();
  for (const StatedRow& row : rows) {
    request.selected_condition.push_back(row.condition);
    request.selected_band.push_back(row.band);
  }
  for (auto* selected : {&request.selected_condition, &request.selected_band}) {
    std::sort(selected->begin(), selected->end());
    selected->erase(std::unique(selected->begin(), selected->end()), selected->end());
  }
  ASSIGN_OR_RETURN(const auto reference, simulator.measure(request, planned));
  for (StatedRow& row : rows) {
    const auto same =
        std::find_if(reference.row.begin(), reference.row.end(), [&](const SignatureResult& r) {
          return r.condition == row.condition && r.band == row.band;
        });
    if (same == reference.row.end())
      return absl::InternalError("a view's longer run does not have all of its rows");
    RETURN_IF_ERROR(add_stated_reference(*same, row));
  }
  return CheckedErrors{std::move(rows), samples / own, reference.samples};
}

StatedErrorSummary summary_of(std::span<const StatedRow> rows, Stated what) {
  StatedErrorSummary out;
  std::vector<double> ratios;
  const auto add = [&](const StatedValue& v) {
    ratios.push_back(v.of_stderr());
    if (std::isnan(v.numerical_error)) return;
    const double ratio = v.of_numerical_error();
    ++out.with_numerical_error;
    out.beyond_2 += ratio > 2 ? 1 : 0;
    out.beyond_5 += ratio > 5 ? 1 : 0;
    out.largest_of_numerical_error = std::max(out.largest_of_numerical_error, ratio);
  };
  for (const StatedRow& row : rows) {
    if (what == Stated::kSpectrum)
      for (const StatedValue& v : row.spectrum) add(v);
    else
      add(row.in_band[static_cast<std::size_t>(what)]);
  }
  out.values = ratios.size();
  if (ratios.empty()) return out;
  std::sort(ratios.begin(), ratios.end());
  const auto rank = [&](double q) {
    return ratios[static_cast<std::size_t>(std::ceil(q * static_cast<double>(ratios.size()))) - 1];
  };
  out.median = rank(0.5);
  out.percentile_95 = rank(0.95);
  out.largest = ratios.back();
  return out;
}

}  // namespace irsig
