#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/replicates.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/request.h"
#include "core/signature/view/result.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// A view whose inputs are somewhat different: another air, other temperatures, other materials on
// the same mesh. Of the request only conditions, environment and air are looked at; conditions have
// the view's own suns.
struct MovedView {
  ViewRequest request;
  std::shared_ptr<const PreparedScene> scene = nullptr;  // null: the view's
};

// Difference between a row of the moved view and that of the view. Means over replicates that share
// their random numbers: their scatter is the difference's alone.  [W/sr]
struct RowChange {
  Estimate source, apparent, contrast;
};

// The view that was measured, to be seen with moved inputs. All outlive it.
struct MeasuredPaths {
  const PreparedScene& scene;
  const ViewRequest& request;
  const ViewPlan& plan;
  const PreparedView& view;
  const ViewResult& result;
  std::span<const PathWeights> weights;  // of its paths
};

// Computes the changes of all rows under moved inputs, [row of the result]. The same paths are used
// again; where inputs decide how paths weigh (materials; a wind under glitter), they are traced a
// second time with the same random numbers. Effects that the view leaves out are left out. Each
// air's rings of directions follow its own horizon; weights are those of the view's rings.
// INVALID_ARGUMENT as in Environment::view().
[[nodiscard]] absl::StatusOr<std::vector<RowChange>> row_changes(const MeasuredPaths& measured,
                                                                 const MovedView& moved);

}  // namespace irsig
