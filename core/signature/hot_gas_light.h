#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/signature/light_component.h"

namespace irsig {

// Measures the light of hot gas, seen and reflected; null: no selected condition has any. Errors
// as gas_rows() has them.
[[nodiscard]] absl::StatusOr<std::unique_ptr<const LightComponent>> measure_hot_gas(
    const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
    const std::shared_ptr<const PreparedView>& view, const PictureFrame& pictures);

}  // namespace irsig
