#include "planning/effects_check.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/accuracy/cost_model.h"
#include "core/base/status_macros.h"
#include "runner/spec_to_request.h"

namespace irsig {
namespace {

struct ChosenViewRows {
  std::uint64_t view;
  std::vector<std::uint32_t> condition, band;
};

std::vector<std::uint32_t> up_to(int n) {
  std::vector<std::uint32_t> out;
  for (int i = 0; i < n; ++i) out.push_back(static_cast<std::uint32_t>(i));
  return out;
}

// The rows that --row names, each by itself, or all rows of --views viewpoints.
absl::StatusOr<std::vector<ChosenViewRows>> chosen_rows(const schema::ResolvedSweep& sweep,
                                                        const EffectsCheckAsked& asked) {
  const auto views = static_cast<std::uint64_t>(sweep.viewpoint_size()),
             conditions = static_cast<std::uint64_t>(sweep.condition_size()),
             bands = static_cast<std::uint64_t>(sweep.sweep().band_size());
  std::vector<ChosenViewRows> out;
  for (const std::uint64_t row : asked.row) {
    if (row == 0 || row > views * conditions * bands)
      return absl::InvalidArgumentError(
          absl::StrCat("--row ", row, ": the sweep has rows 1 to ", views * conditions * bands));
    const std::uint64_t in_view = (row - 1) % (conditions * bands);
    out.push_back({(row - 1) / (conditions * bands),
                   {static_cast<std::uint32_t>(in_view / bands)},
                   {static_cast<std::uint32_t>(in_view % bands)}});
  }
  if (!out.empty()) return out;
  auto chosen = spread_views(views, asked.views);
  std::sort(chosen.begin(), chosen.end());
  for (const std::uint64_t view : chosen)
    out.push_back({view, up_to(sweep.condition_size()), up_to(sweep.sweep().band_size())});
  return out;
}

}  // namespace

absl::StatusOr<std::vector<CheckedView>> check_sweep_effects(
    const LoadedSweep& loaded, const EffectsCheckAsked& asked, const CpuClock& cpu_s,
    const std::function<void(const CheckedView&)>& seen) {
  const schema::ResolvedSweep& sweep = loaded.resolved;
  if (!(sweep.sweep().accuracy().relative_error() > 0))
    return absl::InvalidArgumentError(
        "verify-effects: the sweep asks for no relative error, so that nothing would be left out: "
        "say --relative-error");
  ASSIGN_OR_RETURN(const auto rows, chosen_rows(sweep, asked));
  ASSIGN_OR_RETURN(const auto scene, scene_from_sweep(sweep, loaded.assets, loaded.heat));
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  // One for each of the two runs: neither profits from what the other has made.
  ASSIGN_OR_RETURN(const auto for_chosen, environment_from_sweep(sweep, simulator->band_grids()));
  ASSIGN_OR_RETURN(const auto for_all, environment_from_sweep(sweep, simulator->band_grids()));
  ASSIGN_OR_RETURN(const auto plumes, plumes_from_sweep(sweep, loaded.assets));
  std::vector<CheckedView> views;
  for (const ChosenViewRows& chosen : rows) {
    schema::ViewJob job;
    job.set_viewpoint_index(static_cast<std::uint32_t>(chosen.view));
    job.mutable_condition_index()->Assign(chosen.condition.begin(), chosen.condition.end());
    job.mutable_band_index()->Assign(chosen.band.begin(), chosen.band.end());
    ASSIGN_OR_RETURN(auto request, request_from_job(sweep, job, for_chosen, scene.temperatures,
                                                    scene.land, plumes));
    request.effects = {EffectChoice::Mode::kAuto, {}};
    ASSIGN_OR_RETURN(
        auto view,
        check_effects(*simulator, std::move(request),
                      {for_all, views.empty(), asked.timed, asked.reference_paths}, cpu_s));
    seen(view);
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace irsig
