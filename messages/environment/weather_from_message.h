#pragma once

#include <span>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/environment/air.h"
#include "core/environment/environment.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns true if the sweep's air is the embedded atmosphere.
[[nodiscard]] bool has_atmosphere(const schema::ResolvedSweep& sweep);

// Returns true if a condition's sea has slopes that mirror the sun.
[[nodiscard]] bool is_rough_sea(const schema::Surroundings& surroundings);

// Returns the air of homogeneous surroundings, or no air. With the embedded atmosphere the result
// is no air.
[[nodiscard]] absl::StatusOr<Air> air_from_message(const schema::Air& message);

// Returns the height [m] of the point that represents a target on sea or ground, above the surface.
// It is half the height of a generated model, or 5 m for a model from a file, and at least 1 m.
// model.offset_m raises the point by the same amount; if place.above_surface_m is stated, even as
// 0, the height is 1 m. The height depends on the resolved sweep alone, so that a later evaluation
// of a stored sweep uses the same air. A change of 10 m alters the amounts on a path below 2 km by
// at most 0.5 % (water vapour halves in 1.5-2 km).
[[nodiscard]] double target_height_m(const schema::ResolvedSweep& sweep);

// Returns the height of the target's reference point above sea or ground, in a condition of the
// sweep. [m]
[[nodiscard]] double above_surface_m(const schema::ResolvedSweep& sweep,
                                     const schema::Condition& condition);

// Returns the height [m] of the point that represents the target, if its reference point is so high
// above the surface: the reference point itself, at least 1 m up. above_surface_m = 0: the target
// stands on the surface.
[[nodiscard]] double air_point_height_m(const schema::ResolvedSweep& sweep, double above_surface_m);

// Returns the names that air.aerosol may have, in the order of AerosolKind.
[[nodiscard]] std::span<const char* const> aerosol_names();
[[nodiscard]] absl::StatusOr<AerosolKind> aerosol_named(std::string_view name);

// Returns the profile of a condition's weather: an AFGL profile or the profile of a file, adjusted
// to the surface weather if there is any. INVALID_ARGUMENT: errors in the file, as
// file:line:column: ..., or a surface weather that no air can have.
[[nodiscard]] absl::StatusOr<AirProfile> profile_from_message(const schema::Weather& weather);

// Converts a layer of cloud to a CloudSpec. The message must be complete, as resolve_sweep writes
// it. INVALID_ARGUMENT: a layer outside the limits of core/atmosphere/cloud.h.
[[nodiscard]] absl::StatusOr<CloudSpec> cloud_from_message(const schema::CloudLayer& layer);

[[nodiscard]] absl::StatusOr<WeatherSpec> weather_from_message(
    const schema::Weather& weather, const schema::Surroundings& surroundings);

}  // namespace irsig
