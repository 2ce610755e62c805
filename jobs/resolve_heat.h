#pragma once

#include <vector>

#include "jobs/season_course.h"
#include "schema/job.pb.h"

namespace irsig {

// [heat], and what makes sense only with it or without it: build_up of parts, place.speed_m_s. What
// a build_up is made of is checked elsewhere.
void check_heat(const schema::Sweep& sweep, Findings& findings);
void write_heat_defaults(schema::Sweep& sweep);

// Writes ResolvedSweep.heat, a run for each group of seasons with a part or a material of the land
// whose temperature is stated nowhere and has a build_up, and names it in the conditions (all of
// which are resolved).
// Equal runs are one.
void resolve_heat(const std::vector<SeasonGroup>& groups, schema::ResolvedSweep& resolved,
                  Findings& findings);

}  // namespace irsig
