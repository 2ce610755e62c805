#include "core/signature/simulator.h"

#include <utility>

#include "core/signature/make_plan.h"
#include "core/signature/measure_view.h"

namespace irsig {

absl::StatusOr<std::unique_ptr<Simulator>> Simulator::create(const SceneSpec& spec) {
  auto scene = PreparedScene::make(spec);
  if (!scene.ok()) return scene.status();
  return std::unique_ptr<Simulator>(new Simulator(*std::move(scene)));
}

absl::StatusOr<ViewResult> Simulator::simulate(const ViewRequest& request) const {
  const auto planned = prepare(request);
  if (!planned.ok()) return planned.status();
  return measure(request, *planned);
}

absl::StatusOr<PlannedView> Simulator::prepare(const ViewRequest& request) const {
  auto made = make_plan(scene_, request);
  if (!made.ok()) return made.status();
  return PlannedView{std::move(made->plan), std::move(made->prepared)};
}

absl::StatusOr<ViewResult> Simulator::measure(const ViewRequest& request,
                                              const PlannedView& planned) const {
  return measure_view(scene_, request, planned.plan, planned.prepared);
}

absl::StatusOr<Simulator::MeasuredWithMoves> Simulator::measure(
    const ViewRequest& request, const PlannedView& planned,
    std::span<const MovedView> moved) const {
  auto prepared = prepared_for(scene_, request, planned.plan, planned.prepared);
  if (!prepared.ok()) return prepared.status();
  std::vector<PathWeights> paths;
  auto view =
      measure_view(scene_, request, planned.plan, *prepared, moved.empty() ? nullptr : &paths);
  if (!view.ok()) return view.status();
  MeasuredWithMoves out{*std::move(view), {}};
  for (const MovedView& each : moved) {
    auto change = row_changes({scene_, request, planned.plan, **prepared, out.view, paths}, each);
    if (!change.ok()) return change.status();
    out.change.push_back(*std::move(change));
  }
  return out;
}

absl::StatusOr<ViewPlan> Simulator::plan(const ViewRequest& request) const {
  auto planned = prepare(request);
  if (!planned.ok()) return planned.status();
  return std::move(planned->plan);
}

}  // namespace irsig
