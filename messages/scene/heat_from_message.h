#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/atmosphere/air_profile.h"
#include "core/thermal/scene/scene_heat.h"
#include "core/thermal/weather_course.h"
#include "schema/job.pb.h"

namespace irsig {

// Conversions of a heat run: walls, weather, the surface below and the sky.

// Converts a build-up. path: place of the build-up in the sweep file, for errors.
[[nodiscard]] absl::StatusOr<WallBuildUp> wall_from_message(const schema::BuildUp& message,
                                                            const std::string& path);

[[nodiscard]] WeatherCourse course_from_message(const schema::WeatherCourse& message);

// Converts the ground or sea of a sweep. INVALID_ARGUMENT: surroundings without a sea or ground.
[[nodiscard]] absl::StatusOr<GroundBoundary> ground_from_message(const schema::Sweep& sweep,
                                                                 const schema::Surroundings& s);

// Converts a layer of cloud above walls, in the air of a profile. INVALID_ARGUMENT: as
// cloud_from_message.
[[nodiscard]] absl::StatusOr<CloudAbove> cloud_above(const schema::CloudLayer& layer,
                                                     const AirProfile& profile);

// Converts the sky of a heat run. solar_albedo: albedo of the ground.
[[nodiscard]] absl::StatusOr<SkyAerosol> sky_from_message(const schema::HeatRun& heat,
                                                          double solar_albedo);

}  // namespace irsig
