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

// InvalidArgument names what is wrong in the request, or the interval, the element and the number
// that an exposure has wrong. An element that does not reach its tolerance at max_level is no
// error: its error_k says so.
[[nodiscard]] absl::StatusOr<HeatResult> solve_heat(const HeatRequest& request,
                                                    const ExposureOf& exposure_of);

}  // namespace irsig
