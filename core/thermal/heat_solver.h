#pragma once

#include "absl/status/statusor.h"
#include "core/thermal/heat_request.h"

namespace irsig {

// Temperatures of walls in changing weather: heat conducted through layers, radiation and
// convection at the faces. Equations, errors and limits: docs/explanation/methods/thermal.md.
//
// Elements that share their layers, their kind of inner side and their knots are one request. Each
// element's result depends on nothing else: not on its neighbours in the request, not on their
// number, to the last bit.

// Computes the temperatures of a request. INVALID_ARGUMENT names the fault of the request, or the
// interval, the element and the wrong number of an exposure. An element that does not reach its
// tolerance at max_level is no error: error_k states it.
[[nodiscard]] absl::StatusOr<HeatResult> solve_heat(const HeatRequest& request,
                                                    const ExposureOf& exposure_of);

}  // namespace irsig
