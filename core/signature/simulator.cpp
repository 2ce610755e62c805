#include "core/signature/simulator.h"

#include <utility>

#include "core/base/status_macros.h"
#include "core/signature/make_plan.h"
#include "core/signature/measure_view.h"

namespace irsig {

absl::StatusOr<std::unique_ptr<Simulator>> Simulator::create(const SceneSpec& spec) {
  ASSIGN_OR_RETURN(auto scene, PreparedScene::make(spec));
  return std::unique_ptr<Simulator>(new Simulator(std::move(scene)));
}

absl::StatusOr<ViewResult> Simulator::simulate(const ViewRequest& request) const {
  ASSIGN_OR_RETURN(const auto planned, prepare(request));
  return measure(request, planned);
}

absl::StatusOr<PlannedView> Simulator::prepare(const ViewRequest& request) const {
  ASSIGN_OR_RETURN(auto made, make_plan(scene_, request));
  return PlannedView{std::move(made.plan), std::move(made.prepared)};
}

absl::StatusOr<ViewResult> Simulator::measure(const ViewRequest& request,
                                              const PlannedView& planned) const {
  return measure_view(scene_, request, planned.plan, planned.prepared);
}

absl::StatusOr<Simulator::MeasuredWithMoves> Simulator::measure(
    const ViewRequest& request, const PlannedView& planned,
    std::span<const MovedView> moved) const {
  ASSIGN_OR_RETURN(auto prepared, prepared_for(scene_, request, planned.plan, planned.prepared));
  std::vector<PathWeights> paths;
  ASSIGN_OR_RETURN(auto view, measure_view(scene_, request, planned.plan, prepared,
                                           moved.empty() ? nullptr : &paths));
  MeasuredWithMoves out{std::move(view), {}};
  for (const MovedView& each : moved) {
    ASSIGN_OR_RETURN(
        auto change,
        row_changes({scene_, request, planned.plan, *prepared, out.view, paths}, each));
    out.change.push_back(std::move(change));
  }
  return out;
}

absl::StatusOr<ViewPlan> Simulator::plan(const ViewRequest& request) const {
  ASSIGN_OR_RETURN(auto planned, prepare(request));
  return std::move(planned.plan);
}

}  // namespace irsig
