#include "core/study/effects_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

struct Run {
  PlannedView planned;
  ViewResult result;
  double cpu_s = 0;
};

absl::StatusOr<Run> plan_and_measure(const Simulator& simulator, const ViewRequest& request,
                                     const CpuClock& cpu_s) {
  const double start_s = cpu_s();
  ASSIGN_OR_RETURN(auto planned, simulator.prepare(request));
  ASSIGN_OR_RETURN(auto result, simulator.measure(request, planned));
  return Run{std::move(planned), std::move(result), cpu_s() - start_s};
}

struct RunsOfQuantity {
  const Estimate& value;
  const std::vector<double>& replicate;
  double numerical_error, omitted_bound;
};

RunsOfQuantity quantity_of(const SignatureResult& r, Compared which) {
  switch (which) {
    case Compared::kApparent:
      return {r.apparent_intensity_w_sr, r.replicate_apparent_w_sr, r.apparent_numerical_error_w_sr,
              r.apparent_omitted_bound_w_sr};
    case Compared::kContrast:
      return {r.contrast_intensity_w_sr, r.replicate_contrast_w_sr, r.contrast_numerical_error_w_sr,
              r.contrast_omitted_bound_w_sr};
    case Compared::kSource:
      break;
  }
  return {r.intensity_w_sr, r.replicate_w_sr, r.numerical_error_w_sr, r.omitted_bound_w_sr};
}

// The sums that contrast is a difference of are as large as the brighter of target and background.
double rounding_w_sr(const SignatureResult& r) {
  const double apparent = std::abs(r.apparent_intensity_w_sr.value),
               behind = std::abs(apparent - r.contrast_intensity_w_sr.value);
  return kRoundingRelative * std::max({std::abs(r.intensity_w_sr.value), apparent, behind});
}

absl::StatusOr<ComparedValue> compare(const SignatureResult& chosen, const SignatureResult& all,
                                      Compared which) {
  const RunsOfQuantity a = quantity_of(chosen, which), b = quantity_of(all, which);
  if (a.replicate.size() < 2 || a.replicate.size() != b.replicate.size())
    return absl::InternalError("two runs of a view do not have the same replicates");
  ReplicateStatistics difference(1);
  for (std::size_t i = 0; i < a.replicate.size(); ++i) {
    const double d = a.replicate[i] - b.replicate[i];
    difference.add({&d, 1});
  }
  ComparedValue out;
  out.chosen_w_sr = a.value.value;
  out.all_w_sr = b.value.value;
  out.difference_w_sr = difference.estimate(0).value;
  out.paired_stderr_w_sr = difference.estimate(0).stderr_;
  out.omitted_bound_w_sr = a.omitted_bound;
  out.rounding_w_sr = std::max(rounding_w_sr(chosen), rounding_w_sr(all));
  out.stderr_w_sr = a.value.stderr_;
  out.numerical_error_w_sr = a.numerical_error;
  return out;
}

void take_reference(const SignatureResult& reference, CheckedRow& row) {
  for (std::size_t q = 0; q < kCompared; ++q) {
    const Estimate& e = quantity_of(reference, static_cast<Compared>(q)).value;
    row.value[q].reference_w_sr = e.value;
    row.value[q].reference_stderr_w_sr = e.stderr_;
  }
}

absl::StatusOr<std::vector<CheckedRow>> compare_rows(const ViewResult& chosen,
                                                     const ViewResult& all) {
  if (chosen.row.size() != all.row.size())
    return absl::InternalError("two runs of a view do not have the same rows");
  std::vector<CheckedRow> out;
  for (std::size_t i = 0; i < chosen.row.size(); ++i) {
    const SignatureResult& r = chosen.row[i];
    CheckedRow& row = out.emplace_back();
    row.condition = r.condition;
    row.band = r.band;
    row.reflections = r.reflections;
    const bool cloudy = std::any_of(r.effect.begin(), r.effect.end(),
                                    [](const LedgerEntry& e) { return is_of_cloud(e.effect); });
    if (r.effect.size() !=
        kEffects + (cloudy ? kCloudEffects : 0) + (r.has_plume ? kPlumeEffects : 0))
      return absl::InternalError("a row does not have its ledger of effects");
    row.effect.fill(EffectState::kAbsent);
    for (const LedgerEntry& e : r.effect) row.effect[static_cast<std::size_t>(e.effect)] = e.state;
    for (std::size_t q = 0; q < kCompared; ++q) {
      ASSIGN_OR_RETURN(auto value, compare(r, all.row[i], static_cast<Compared>(q)));
      row.value[q] = value;
    }
  }
  return out;
}

absl::Status add_reference(const Simulator& simulator, ViewRequest request, PlannedView planned,
                           const EffectsCheckOptions& options, CheckedView& view) {
  const double wanted =
                   std::ceil(options.reference_paths * static_cast<double>(view.chosen_samples)),
               most = static_cast<double>(
                   std::max(options.most_reference_samples, view.chosen_samples));
  request.seed += 1;
  planned.plan.samples_per_replicate = static_cast<std::uint64_t>(std::min(wanted, most));
  ASSIGN_OR_RETURN(const auto reference, simulator.measure(request, planned));
  for (std::size_t i = 0; i < view.row.size(); ++i) take_reference(reference.row[i], view.row[i]);
  view.referenced = true;
  return absl::OkStatus();
}

}  // namespace

double ComparedValue::of_allowed() const {
  const double allowed = allowed_w_sr(), difference = std::abs(difference_w_sr);
  if (allowed > 0) return difference / allowed;
  return difference == 0 ? 0 : std::numeric_limits<double>::infinity();
}

double ComparedValue::of_numerical_error() const {
  const double error = std::hypot(numerical_error_w_sr, reference_stderr_w_sr, rounding_w_sr),
               difference = std::abs(chosen_w_sr - reference_w_sr);
  if (error > 0) return difference / error;
  return difference == 0 ? 0 : std::numeric_limits<double>::infinity();
}

bool CheckedRow::is_off(Effect which) const {
  return effect[static_cast<std::size_t>(which)] == EffectState::kOff;
}

bool CheckedRow::drops_reflections() const {
  return is_off(Effect::kSkyReflected) || is_off(Effect::kLowerReflected) ||
         is_off(Effect::kInterReflection);
}

absl::StatusOr<CheckedView> check_effects(const Simulator& simulator, ViewRequest request,
                                          const EffectsCheckOptions& options,
                                          const CpuClock& cpu_s) {
  request.thumbnail_px = 0;
  ViewRequest with_all = request;
  with_all.effects = {EffectChoice::Mode::kAll, {}};
  if (options.environment_for_all != nullptr) with_all.environment = options.environment_for_all;
  CheckedView view;
  view.viewpoint = request.viewpoint;
  if (options.first_view) {
    ASSIGN_OR_RETURN(const auto chosen, plan_and_measure(simulator, request, cpu_s));
    ASSIGN_OR_RETURN(const auto all, plan_and_measure(simulator, with_all, cpu_s));
    view.chosen_first_s = chosen.cpu_s;
    view.all_first_s = all.cpu_s;
  }
  Run chosen, all;
  // The runs take turns, so that a machine that slows down does so for both.
  for (std::uint32_t i = 0; i < std::max(options.timed, 1u); ++i) {
    ASSIGN_OR_RETURN(auto a, plan_and_measure(simulator, request, cpu_s));
    ASSIGN_OR_RETURN(auto b, plan_and_measure(simulator, with_all, cpu_s));
    view.chosen_s = i == 0 ? a.cpu_s : std::min(view.chosen_s, a.cpu_s);
    view.all_s = i == 0 ? b.cpu_s : std::min(view.all_s, b.cpu_s);
    chosen = std::move(a);
    all = std::move(b);
  }
  view.chosen_samples = chosen.planned.plan.samples_per_replicate;
  view.all_samples = all.planned.plan.samples_per_replicate;
  // Take the paths of the chosen run: as many, and aimed likewise.
  if (all.planned.plan.samples_per_replicate != chosen.planned.plan.samples_per_replicate ||
      all.planned.plan.bright != chosen.planned.plan.bright) {
    PlannedView planned = all.planned;
    planned.plan.samples_per_replicate = chosen.planned.plan.samples_per_replicate;
    planned.plan.bright = chosen.planned.plan.bright;
    ASSIGN_OR_RETURN(auto result, simulator.measure(with_all, planned));
    all.result = std::move(result);
  }
  ASSIGN_OR_RETURN(view.row, compare_rows(chosen.result, all.result));
  if (options.reference_paths > 0) {
    RETURN_IF_ERROR(add_reference(simulator, with_all, all.planned, options, view));
  }
  return view;
}

EffectsSummary summary_of(std::span<const CheckedView> views) {
  EffectsSummary out;
  out.views = views.size();
  out.drops_reflections = !views.empty();
  for (const CheckedView& view : views) {
    out.chosen_s += view.chosen_s;
    out.all_s += view.all_s;
    out.chosen_first_s += view.chosen_first_s;
    out.all_first_s += view.all_first_s;
    for (const CheckedRow& row : view.row) {
      ++out.rows;
      out.drops_reflections &= row.drops_reflections();
      for (std::size_t e = 0; e < kEffectCount; ++e)
        out.off[e] += row.effect[e] == EffectState::kOff ? 1 : 0;
      for (const ComparedValue& v : row.value) {
        ++out.values;
        out.largest_of_allowed = std::max(out.largest_of_allowed, v.of_allowed());
        // A NaN is out of bound too.
        out.out_of_bound += v.of_allowed() <= 1 ? 0 : 1;
        if (!view.referenced) continue;
        ++out.referenced;
        out.largest_of_numerical_error =
            std::max(out.largest_of_numerical_error, v.of_numerical_error());
        out.beyond_2 += v.of_numerical_error() <= 2 ? 0 : 1;
        out.beyond_5 += v.of_numerical_error() <= 5 ? 0 : 1;
      }
    }
  }
  return out;
}

}  // namespace irsig
