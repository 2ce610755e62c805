#pragma once

#include "absl/status/status.h"
#include "core/signature/measured_view.h"
#include "core/signature/view/request.h"
#include "core/signature/view/result.h"

namespace irsig {

// Adds SignatureResult::clutter to the rows of a view on land. INVALID_ARGUMENT as
// Environment::view() has it.
[[nodiscard]] absl::Status add_clutter(const MeasuredView& view, const ViewRequest& request,
                                       ViewResult& result);

}  // namespace irsig
