#include "planning/accuracy_effects.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/effects/effects.h"
#include "runner/spec_to_request.h"

namespace irsig {
namespace {

constexpr std::array<double, 6> kAsked = {0.1, 0.03, 0.01, 0.003, 0.001, 0.0003};

schema::ResolvedSweep one_row(const schema::ResolvedSweep& sweep, std::uint32_t condition,
                              std::uint32_t band) {
  schema::ResolvedSweep out = sweep;
  const schema::Condition& only = sweep.condition(static_cast<int>(condition));
  out.mutable_sweep()->clear_season();
  *out.mutable_sweep()->add_season() = sweep.sweep().season(static_cast<int>(only.season_index()));
  out.clear_condition();
  *out.add_condition() = only;
  out.mutable_condition(0)->set_season_index(0);
  const schema::Band only_band = sweep.sweep().band(static_cast<int>(band));
  out.mutable_sweep()->clear_band();
  *out.mutable_sweep()->add_band() = only_band;
  out.mutable_sweep()->mutable_output()->set_thumbnail_px(0);
  return out;
}

std::string left_out_of(const SignatureResult& row, std::uint32_t allowed_reflections) {
  std::string names;
  for (const LedgerEntry& e : row.effect)
    if (e.state == EffectState::kOff)
      absl::StrAppend(&names, names.empty() ? "" : ", ", std::string(info_of(e.effect).name));
  if (row.reflections > 0 && row.reflections < allowed_reflections)
    absl::StrAppend(&names, names.empty() ? "" : ", ", "reflections after ", row.reflections);
  return names;
}

}  // namespace

absl::StatusOr<EffectsCurves> effects_curves(const schema::ResolvedSweep& sweep,
                                             const Assets& assets, const HeatOutputs& heat,
                                             const Viewpoint& viewpoint, std::uint32_t condition,
                                             std::uint32_t band, const ReferenceValue& reference,
                                             WorkBudget budget, const CpuClock& cpu_s) {
  const schema::ResolvedSweep row = one_row(sweep, condition, band);
  ASSIGN_OR_RETURN(const auto scene, scene_from_sweep(row, assets, heat));
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  budget.cpu_s /= 2;
  budget.primary_rays /= 2;
  budget.least_seeds = 6;
  EffectsCurves out;
  for (const auto& [name, mode] : {std::pair{kAutomatic, EffectChoice::Mode::kAuto},
                                   std::pair{kAllEffects, EffectChoice::Mode::kAll}}) {
    // Each has its own environment: a simulation must not profit from the air and sky that another
    // one has already computed.
    ASSIGN_OR_RETURN(const auto environment, environment_from_sweep(row, simulator->band_grids()));
    ASSIGN_OR_RETURN(auto request,
                     request_from_job(row, {}, environment, scene.temperatures, scene.land, {}));
    request.viewpoint = viewpoint;
    request.selected_condition = request.selected_band = {0};
    request.effects = {mode, {}};
    request.accuracy.target_paths = 0;
    request.accuracy.samples_per_replicate = 0;
    // Only the relative error is requested, whatever the value.
    request.accuracy.absolute_error_k = 0;
    const bool automatic = mode == EffectChoice::Mode::kAuto;
    const auto simulate = [&](double asked, std::uint64_t seed) -> absl::StatusOr<EstimateRun> {
      request.accuracy.relative_error = asked;
      request.seed = seed;
      ASSIGN_OR_RETURN(const auto view, simulator->simulate(request));
      if (automatic && (out.left_out.empty() || out.left_out.back().asked_relative_error != asked))
        out.left_out.push_back({asked, left_out_of(view.row.front(), request.max_reflections)});
      return run_of(view, 0);
    };
    ASSIGN_OR_RETURN(auto points,
                     whole_run_curve({name, simulate}, kAsked, reference, budget, cpu_s));
    out.work.push_back({"effects", name, std::move(points)});
  }
  return out;
}

}  // namespace irsig
