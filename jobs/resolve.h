#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "jobs/text/limits.h"
#include "jobs/text/section_check.h"
#include "jobs/text/sweep_places.h"
#include "schema/job.pb.h"

namespace irsig {

// The steps of resolve_sweep, one for each group of tables. Each reads `sweep` as written (before
// any default is filled in) and reports to `findings`. The steps that say so also complete the
// resolved sweep.

// Resolves [model] [[material]] [[part]]. Built-in and library materials that parts name are added
// to sweep.material.
void resolve_target(std::string_view model_bytes, schema::ResolvedSweep& resolved,
                    Findings& findings);

// Resolves [[material]] and returns the names in order. A library entry is written out into
// sweep.material, so that its numbers are part of the sweep.
[[nodiscard]] std::vector<std::string> resolve_materials(schema::Sweep& sweep, Findings& findings);

// Resolves a part's material that no [[material]] declares. If it is built in or in the library, it
// is added to sweep.material and to `known`; otherwise an error is reported.
void resolve_part_material(const std::string& name, const SectionCheck& check,
                           std::vector<std::string>& known, schema::Sweep& sweep,
                           Findings& findings);

// Resolves [[build_up]], and checks that parts and materials have the properties that computed
// temperatures need. Library solids are written out as their numbers.
void resolve_build_ups(schema::Sweep& sweep, Findings& findings);

// Returns true if the sweep file states a part's temperature in a season: its own, or the season's.
[[nodiscard]] bool is_stated(const schema::Season& season, const schema::Part& part);

// Checks [[temperature_field]] and the keys of seasons that name fields.
void check_temperature_fields(const SweepFile& file, Findings& findings);
// Resolves the fields by name, with the hashes of their files. take_temperature_field() copies a
// season's field into its condition, with the parts whose temperatures come from it.
[[nodiscard]] std::map<std::string, schema::ConditionField> resolve_temperature_fields(
    const SweepFile& file);
void take_temperature_field(const std::map<std::string, schema::ConditionField>& fields,
                            const schema::Sweep& sweep, const schema::Season& season,
                            schema::Condition& condition);

// Resolves [place] [[season]] time [air] transport.sun and the surroundings, and writes
// ResolvedSweep.condition if no error was found so far. `file` has the text of the files that air
// and seasons name.
void resolve_conditions(const SweepFile& file, schema::ResolvedSweep& resolved, Findings& findings);

void check_place(const schema::Sweep& sweep, Findings& findings);

// Reports settings that contradict above_surface_m of [place], seasons and conditions.
void check_heights(const schema::Sweep& sweep, Findings& findings);
// Returns the lowest above_surface_m of all seasons. [m]
[[nodiscard]] double lowest_above_surface_m(const schema::Sweep& sweep);

// Checks [air] and the season's settings of air. `surroundings`: complete surroundings of the
// season.
void check_air(const schema::Sweep& sweep, Findings& findings);
void check_season_air(const schema::Sweep& sweep, int season_index,
                      const schema::Surroundings& surroundings, Findings& findings);

// Resolves the weather of a season's conditions, if no error was found so far. `season`: the season
// itself, or the season with the surface weather of one time filled in.
[[nodiscard]] schema::Weather resolve_weather(const SweepFile& file, int season_index,
                                              const schema::Season& season, int month,
                                              Findings& findings);
void write_air_defaults(schema::Air& air);

// Resolves [surroundings] and [season.surroundings]. Returns the complete surroundings of each
// season, in the order of seasons.
[[nodiscard]] std::vector<schema::Surroundings> resolve_surroundings(const schema::Sweep& sweep,
                                                                     Findings& findings);

// Like resolve_surroundings(), for one condition's surroundings, which are complete.
void check_complete_surroundings(const schema::Sweep& sweep, const schema::Surroundings& complete,
                                 const std::string& path, Findings& findings);

// Resolves [viewpoints] and writes ResolvedSweep.viewpoint.
void resolve_viewpoints(schema::ResolvedSweep& resolved, Findings& findings);

// Checks [[band]] [transport] [accuracy] [precompute].
void check_run(const schema::Sweep& sweep, Findings& findings);

// Checks [effects]; write_effect_defaults() writes its defaults.
void check_effects(const SweepFile& file, Findings& findings);
// Checks the names in [effects].
void check_effect_names(const schema::Effects& effects, Findings& findings);
void write_effect_defaults(schema::Sweep& sweep);

// Checks [image] once viewpoints are known; write_image_defaults() writes the defaults of [image]
// and [output].
void check_image(const schema::ResolvedSweep& resolved, Findings& findings);
void write_image_defaults(schema::Sweep& sweep);

// Checks [imager] once all defaults are written.
void check_sweep_imager(const schema::Sweep& sweep, Findings& findings);
// Checks a sweep file only: the sweeps of pilots have no images.
void check_imager_has_images(const schema::Sweep& sweep, Findings& findings);

// Checks [[profile]] and [[published]] once viewpoints and everything else are known;
// write_profile_defaults() writes their defaults.
void check_profiles(const schema::ResolvedSweep& resolved, Findings& findings);
void write_profile_defaults(schema::Sweep& sweep);

}  // namespace irsig
