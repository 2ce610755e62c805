#pragma once

#include <array>
#include <optional>

#include "absl/status/statusor.h"
#include "jobs/text/section_check.h"
#include "schema/job.pb.h"

namespace irsig {

// Resolution of [[season.cloud]] and of a season's keys cloud_cover, cloud_type, cloud_base_m and
// cloud_water_path_g_m2, which state the same layer in a table of conditions.

inline constexpr std::array kCloudKeys = {"cloud", "cloud_cover", "cloud_type", "cloud_base_m",
                                          "cloud_water_path_g_m2"};

// Reports errors of a season's cloud under the embedded atmosphere.
void check_cloud_of_season(const schema::Season& season, int season_index, Findings& findings);

// Returns the cover that a season states itself; nullopt: a weather file's, or none.
[[nodiscard]] std::optional<double> stated_cloud_cover(const schema::Season& season);

// Returns the layer of a season in some weather, whatever its cover: the base of a cloud of
// unknown type is that of the weather.
[[nodiscard]] schema::CloudLayer cloud_layer(const schema::Season& season,
                                             const schema::Weather& weather);

// Writes the layer of a condition whose weather has a cover, and adds the assumptions about the
// layer as a warning. always: also without a cover, if the cover is uncertain.
void resolve_cloud(const schema::Season& season, int season_index, bool always,
                   schema::Weather& weather, schema::Condition& condition, Findings& findings);

// Returns the layer that the keys of [[season.cloud]] state in another text than a sweep file,
// checked as that table is. INVALID_ARGUMENT: names the keys as "cloud.top_m".
[[nodiscard]] absl::StatusOr<schema::CloudLayer> stated_cloud_layer(const schema::Cloud& cloud);

}  // namespace irsig
