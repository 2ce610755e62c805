#include "core/signature/light_component.h"

#include "core/base/status_macros.h"
#include "core/signature/hot_gas_light.h"

namespace irsig {

absl::StatusOr<LightComponents> measure_components(const PreparedScene& scene,
                                                   const ViewRequest& request, const ViewPlan& plan,
                                                   const std::shared_ptr<const PreparedView>& view,
                                                   const PictureFrame& pictures) {
  LightComponents out;
  ASSIGN_OR_RETURN(auto gas, measure_hot_gas(scene, request, plan, view, pictures));
  if (gas != nullptr) out.push_back(std::move(gas));
  return out;
}

}  // namespace irsig
