#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/signature/view/plan.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/request.h"

namespace irsig {

// Returns the error of a request that is meaningless for this scene.
[[nodiscard]] absl::Status check_request(const PreparedScene& scene, const ViewRequest& request);

// Bounds, pilots, the number of samples. prepared: null if nothing had to be seen for it.
struct MadePlan {
  ViewPlan plan;
  std::shared_ptr<const PreparedView> prepared;
};
[[nodiscard]] absl::StatusOr<MadePlan> make_plan(const PreparedScene& scene,
                                                 const ViewRequest& request);

}  // namespace irsig
