#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/signature/plan.h"
#include "core/signature/prepared_scene.h"
#include "core/signature/prepared_view.h"
#include "core/signature/request.h"
#include "core/signature/result.h"

namespace irsig {

// The stored run: statistics, errors and thumbnails of the selected rows. prepared: of the same
// request with the plan's effects; null, or made for other effects: it is made here.
[[nodiscard]] absl::StatusOr<ViewResult> measure_view(const PreparedScene& scene,
                                                      const ViewRequest& request,
                                                      const ViewPlan& plan,
                                                      std::shared_ptr<const PreparedView> prepared);

}  // namespace irsig
