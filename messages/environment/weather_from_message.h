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

// The air of homogeneous surroundings and of none; beside the embedded atmosphere: none.
[[nodiscard]] absl::StatusOr<Air> air_from_message(const schema::Air& message);

// Height of the point that stands for a target on sea or ground, above it: half the height of a
// generated model, 5 m for one from a file, at least 1 m; and as much more as model.offset_m raises
// it; 1 m where place.above_surface_m is stated, even as 0. A function of the resolved sweep alone,
// so that whoever evaluates a stored sweep anew finds the same air. 10 m more or less change the
// amounts of a path that stays below 2 km by 0.5 % at most (water vapour halves in 1.5-2 km).
[[nodiscard]] double target_height_m(const schema::ResolvedSweep& sweep);

// Height of the target's reference point above sea or ground, in a condition of the sweep. [m]
[[nodiscard]] double above_surface_m(const schema::ResolvedSweep& sweep,
                                     const schema::Condition& condition);

// Height of the point that stands for the target, where the reference point lies so high above the
// surface: the reference point itself, at least 1 m up. above_surface_m 0: the target stands on the
// surface.
[[nodiscard]] double air_point_height_m(const schema::ResolvedSweep& sweep, double above_surface_m);

// The names that air.aerosol may have, in the order of AerosolKind.
[[nodiscard]] std::span<const char* const> aerosol_names();
[[nodiscard]] absl::StatusOr<AerosolKind> aerosol_named(std::string_view name);

// The profile of a condition's weather: an AFGL profile or the file's, bent to the surface weather
// if there is any. INVALID_ARGUMENT: what is wrong in the file, as file:line:column: ..., or a
// surface that no air can have.
[[nodiscard]] absl::StatusOr<AirProfile> profile_from_message(const schema::Weather& weather);

// A condition's air and what lies below it, imported paths included. Both messages complete, as
// resolve_sweep writes them.
// INVALID_ARGUMENT: a layer outside the limits of core/atmosphere/cloud.h.
[[nodiscard]] absl::StatusOr<CloudSpec> cloud_from_message(const schema::CloudLayer& layer);

[[nodiscard]] absl::StatusOr<WeatherSpec> weather_from_message(
    const schema::Weather& weather, const schema::Surroundings& surroundings);

}  // namespace irsig
