#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/view/plan.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/request.h"
#include "core/signature/view/result.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// Computes the stored run: statistics, errors and thumbnails of the selected rows.
//   prepared  of the same request with the plan's effects; null, or made for other effects: made
//             anew
//   paths     receives the weights of the paths; null: not wanted
[[nodiscard]] absl::StatusOr<ViewResult> measure_view(const PreparedScene& scene,
                                                      const ViewRequest& request,
                                                      const ViewPlan& plan,
                                                      std::shared_ptr<const PreparedView> prepared,
                                                      std::vector<PathWeights>* paths = nullptr);

// Returns `known` if it was prepared for the request with the plan's effects and places to aim at;
// else a new one.
[[nodiscard]] absl::StatusOr<std::shared_ptr<const PreparedView>> prepared_for(
    const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
    std::shared_ptr<const PreparedView> known);

}  // namespace irsig
