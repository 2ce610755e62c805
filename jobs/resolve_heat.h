#pragma once

#include <vector>

#include "jobs/season_course.h"
#include "schema/job.pb.h"

namespace irsig {

// Checks [heat] and the keys that need it or exclude it: build_up of parts, place.speed_m_s. The
// layers of a build_up are checked elsewhere.
void check_heat(const schema::Sweep& sweep, Findings& findings);
void write_heat_defaults(schema::Sweep& sweep);

// Writes ResolvedSweep.heat: a run for each group of seasons that has a part or a material of the
// land with a build_up and without any stated temperature. Names the run in the conditions, all of
// which are resolved. Equal runs are one.
void resolve_heat(const std::vector<SeasonGroup>& groups, schema::ResolvedSweep& resolved,
                  Findings& findings);

}  // namespace irsig
