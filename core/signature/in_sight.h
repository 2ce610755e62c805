#pragma once

#include <span>

#include "absl/status/status.h"
#include "core/environment/environment.h"
#include "core/geo/viewpoint.h"
#include "core/scene/trace/target.h"
#include "core/sources/condition.h"

namespace irsig {

// Whether a sensor sees something of the target above sea or ground, under conditions of one kind
// of surroundings (of which kind and above_surface_m are looked at). Vertices stand for facets.
//   environment  null: no embedded atmosphere
// INVALID_ARGUMENT: surface or Earth hide all vertices. Where the conditions differ in
// above_surface_m they share paths, so that none of them may hide a vertex.
[[nodiscard]] absl::Status check_in_sight(const Target& target,
                                          std::span<const ConditionSpec> condition,
                                          const Environment* environment,
                                          const Viewpoint& viewpoint);

}  // namespace irsig
