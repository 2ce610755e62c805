#pragma once

#include <optional>
#include <span>

#include "absl/status/status.h"
#include "core/environment/environment.h"
#include "core/geo/viewpoint.h"
#include "core/land/land_scene.h"
#include "core/scene/trace/target.h"
#include "core/sources/condition.h"

namespace irsig {

// Checks that a sensor sees some of the target above sea or ground, under conditions of one kind of
// surroundings (the kind and above_surface_m are used). Vertices stand for facets. Conditions that
// differ in above_surface_m share paths, so that none of them may hide a vertex.
//   environment  null: no embedded atmosphere
//   land         null: none; else it replaces the ground
// INVALID_ARGUMENT: land, surface or Earth hide all vertices; a sensor below the land or inside an
// object on it.
[[nodiscard]] absl::Status check_in_sight(const Target& target,
                                          std::span<const ConditionSpec> condition,
                                          const Environment* environment, const LandScene* land,
                                          const Viewpoint& viewpoint);

// Checks that no vertex of the target lies inside an object of the land. INVALID_ARGUMENT with the
// object's key.
//   above_m  height of the target's reference point above the land below it
[[nodiscard]] absl::Status check_outside_objects(const Target& target, const LandScene& land,
                                                 double above_m);

// Returns the highest step at the edge of a land's map that a sensor has in sight within a square
// window around the target.
//   half_m  of the window's sides, at the target
[[nodiscard]] std::optional<EdgeStep> edge_in_sight(const Target& target, const LandScene& land,
                                                    const Environment* environment, double above_m,
                                                    const Viewpoint& viewpoint, double half_m);

}  // namespace irsig
