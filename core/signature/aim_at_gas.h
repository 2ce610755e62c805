#pragma once

#include "core/plume/plume_field.h"
#include "core/scene/trace/target.h"
#include "core/transport/primary_rays.h"

namespace irsig {

// Returns a view of the target with one stratum, whose rays are denser where the target lies closer
// to what hot gas sends: what the hull reflects of a plume comes mostly from the few facets beside
// its hottest end, which evenly spread rays hardly ever meet.
//
// The gas is taken as a few bulks along its longest axis, each as thin gas that radiates to all
// sides from its middle. A facet's irradiance by these, without shadows, is the weight of the cells
// that it touches; three tenths of the rays are spread evenly. Rays count by the inverse of their
// density, so that a poor guess costs samples, not truth.
inline constexpr double kEvenAtGas = 0.3;
[[nodiscard]] AimedView aim_at_gas(const Target& target, const AimedView& view,
                                   const PlumeField& field);

}  // namespace irsig
