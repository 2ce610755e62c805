#pragma once

#include <string>

#include "jobs/text/section_check.h"
#include "schema/job.pb.h"

namespace irsig {

// Checks that the statements of a resolved sweep about its conditions are consistent. A
// contradiction is reported to `findings` at the key that causes it, with both values named. Values
// that are possible but odd are added to Condition.warning as "<path> ..."; the warning is stored
// with the rows and shown once. docs/reference/keys/air.md, "What is checked", lists every rule.
void check_weather(schema::ResolvedSweep& resolved, Findings& findings);

// Checks names of seasons, dates and the sun, in every sweep that has a place. A part of
// check_weather(), like the functions below.
void check_calendar(schema::ResolvedSweep& resolved, Findings& findings);
// Checks profile, surface weather, sea, ground, parts and imports, only in sweeps with the embedded
// atmosphere. Other sweeps state sky and sea as idealisations (a sea at 0 K), which are not
// restricted.
void check_surfaces(schema::ResolvedSweep& resolved, Findings& findings);

// Adds warnings about temperatures that may be in Celsius, an accuracy that may be in percent, and
// steps that are adjusted.
void check_units(schema::ResolvedSweep& resolved, Findings& findings);

// Checks lines of sight: hidden by the Earth, or not covered by an import; and that imports were
// made for these conditions. check_surfaces calls this if nothing else was found.
void check_lines(schema::ResolvedSweep& resolved, Findings& findings);

// Adds a warning about a key to all conditions of a season.
void warn_season(schema::ResolvedSweep& resolved, int season_index, const std::string& key,
                 const std::string& what, Findings& findings);

// An instant of a condition, with the sun at the sweep's place.
struct SunThere {
  int day_of_year;  // of UTC
  double elevation_deg;
};
[[nodiscard]] SunThere sun_there(const schema::Place& place, const schema::Condition& condition);

}  // namespace irsig
