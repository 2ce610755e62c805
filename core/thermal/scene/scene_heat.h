#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/trace/target.h"
#include "core/thermal/scene/scene_heat_request.h"

namespace irsig {

// Temperatures of all faces of a target outdoors: walls (heat_solver.h) in the weather, sun with
// shadows, and everything exchanging radiation with everything. Equations, errors and limits:
// docs/explanation/methods/thermal.md.

struct SceneHeatResult {
  // [output][facet] Of a sheet the mean of its two faces. Of facets with a stated temperature, of
  // degenerate ones, and of those that nothing from outside reaches (inside other bodies): not a
  // number.
  std::vector<std::vector<float>> kelvin, error_k;
  // [facet] By how much it would be warmer or colder at most, at any time, if that effect were as
  // it is not (heat_bounds.h); empty where none were asked for. Not a number as above.
  std::vector<float> exchange_bound_k, diffuse_sun_bound_k;
  int exchange_rounds = 0;     // passes over the knots, of both computations
  double exchange_left_k = 0;  // what another pass would change at most
  double closure_w_m2 = 0;     // of all walls (HeatResult)
};

// Computes temperatures twice: at all knots, and at every second one with half the rays and other
// points. error_k estimates the error of the stated model alone. It is the sum of
//   - the error of conduction, and the change that further passes would bring;
//   - the difference of the two computations, or its root mean square over the three hours around
//     if that is larger (one difference may be small by luck), or the scatter of blocks of a face's
//     rays;
//   - the difference between places of a facet that sun, sky, ground or a stated temperature
//     reaches unequally, and from the neighbours in its plane (difference / sqrt(2)), since one
//     temperature stands for all of it;
//   - half of the difference between the two faces of a sheet.
//
// INVALID_ARGUMENT names the fault of the request or of a build-up, and refuses more faces x knots
// than fit into memory, or an effect that is off and whose bound is not known.
[[nodiscard]] absl::StatusOr<SceneHeatResult> solve_scene_heat(const Target& target,
                                                               const SceneHeatRequest& request);

// Changes of temperatures under other requests (of the same faces, knots and outputs: another
// weather, other walls). [output][facet], not a number as above  [K]
using TemperatureChange = std::vector<std::vector<float>>;
// Computes the changes from every second knot, with half the rays, as the second computation above.
// Both sides of each difference have the errors of that computation, which cancel but for their
// effect on the difference. Each computation begins at the temperatures of `request`, so that few
// rounds are left. Errors as above.
//
// If a moved request is of the model (SceneHeatRequest::of_model), a change is at least as large as
// its root mean square over the 24 h around, with its own sign: twice a day a change of convection
// or moisture passes through zero, where the model is not better than elsewhere.
[[nodiscard]] absl::StatusOr<std::vector<TemperatureChange>> solve_scene_heat_changes(
    const Target& target, const SceneHeatRequest& request, std::span<const SceneHeatRequest> moved);

}  // namespace irsig
