#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/input_changes.h"
#include "core/signature/view/plan.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"
#include "core/signature/view/result.h"

namespace irsig {

struct PreparedView;  // core/signature/view/prepared_view.h

// A plan and what was made of the view on the way to it, which measure() then need not make again.
struct PlannedView {
  ViewPlan plan;
  std::shared_ptr<const PreparedView> prepared;  // null: measure() makes it
};

// A scene ready for any number of viewpoints. Immutable: simulate() may run on several threads.
class Simulator {
 public:
  static absl::StatusOr<std::unique_ptr<Simulator>> create(const SceneSpec& spec);

  // Calls prepare() and measure().
  [[nodiscard]] absl::StatusOr<ViewResult> simulate(const ViewRequest& request) const;
  [[nodiscard]] absl::StatusOr<PlannedView> prepare(const ViewRequest& request) const;
  // Measures the planned request. Its seed and selection may differ, and the plan's number of
  // samples may be changed: requests with different numbers of samples have the same paths as far
  // as both follow them.
  [[nodiscard]] absl::StatusOr<ViewResult> measure(const ViewRequest& request,
                                                   const PlannedView& planned) const;

  // measure(), and by how much each row changes if inputs are moved. [moved][row]
  struct MeasuredWithMoves {
    ViewResult view;
    std::vector<std::vector<RowChange>> change;
  };
  [[nodiscard]] absl::StatusOr<MeasuredWithMoves> measure(const ViewRequest& request,
                                                          const PlannedView& planned,
                                                          std::span<const MovedView> moved) const;

  // Plans and measures without the intermediate results of PlannedView.
  [[nodiscard]] absl::StatusOr<ViewPlan> plan(const ViewRequest& request) const;
  [[nodiscard]] absl::StatusOr<ViewResult> measure(const ViewRequest& request,
                                                   const ViewPlan& plan) const {
    return measure(request, PlannedView{plan, nullptr});
  }

  [[nodiscard]] const PreparedScene& scene() const { return scene_; }
  [[nodiscard]] const Target& target() const { return scene_.target; }
  // Prepared at every node of the bands, one band after the other.
  [[nodiscard]] const std::vector<Material>& materials() const { return scene_.material; }
  // Prepared at the nodes that paths carry: all of basis().carried.
  [[nodiscard]] const std::vector<Material>& carried_materials() const {
    return scene_.carried_material();
  }
  [[nodiscard]] const SpectralBasis& basis() const { return scene_.basis; }
  [[nodiscard]] const std::vector<Band>& bands() const { return scene_.band; }
  [[nodiscard]] const std::vector<BandGrid>& band_grids() const { return scene_.axis.grids(); }
  [[nodiscard]] bool energy_gain() const { return scene_.energy_gain; }
  [[nodiscard]] std::uint64_t scene_hash() const { return scene_.hash; }

 private:
  explicit Simulator(PreparedScene scene) : scene_(std::move(scene)) {}
  PreparedScene scene_;
};

}  // namespace irsig
