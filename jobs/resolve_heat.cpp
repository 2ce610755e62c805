#include "jobs/resolve_heat.h"

#include <algorithm>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "jobs/resolve.h"
#include "jobs/resolve_cloud.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_plume.h"

namespace irsig {
namespace {

schema::WeatherCourse message_of(const WeatherCourse& course) {
  schema::WeatherCourse out;
  out.set_radiation_interval_s(course.radiation_interval_s);
  out.set_periodic(course.periodic);
  for (const WeatherRecord& r : course.record) {
    schema::WeatherRecord& to = *out.add_record();
    to.set_unix_s(r.unix_s);
    to.set_air_temperature_k(r.air_k);
    to.set_dew_point_k(r.dew_point_k);
    to.set_pressure_pa(r.pressure_pa);
    to.set_wind_speed_m_s(r.wind_m_s);
    to.set_wind_from_deg(r.wind_from_deg);
    to.set_cloud_cover(r.cloud_cover);
    if (r.direct_normal_w_m2) to.set_direct_normal_w_m2(*r.direct_normal_w_m2);
    if (r.diffuse_horizontal_w_m2) to.set_diffuse_horizontal_w_m2(*r.diffuse_horizontal_w_m2);
    if (r.sky_w_m2) to.set_sky_w_m2(*r.sky_w_m2);
  }
  return out;
}

// Two runs are one if these are equal.
std::string bytes_of(schema::HeatRun run) {
  run.clear_season();
  run.clear_time_utc();
  return run.SerializeAsString();
}

// Temperature of parts in a run that computes only land; it is not used.
constexpr double kUnusedK = 290;

// The parts whose temperatures are computed in a season.
std::vector<int> computed_parts(const schema::Sweep& sweep, const schema::Season& season) {
  std::vector<int> out;
  for (int p = 0; p < sweep.part_size(); ++p)
    if (sweep.part(p).has_build_up() && !is_stated(season, sweep.part(p))) out.push_back(p);
  return out;
}

}  // namespace

void check_heat(const schema::Sweep& sweep, Findings& findings) {
  if (!sweep.has_heat()) {
    for (int p = 0; p < sweep.part_size(); ++p) {
      if (!sweep.part(p).has_build_up()) continue;
      const std::string path = absl::StrCat("part[", p, "].build_up");
      findings.add(path, absl::StrCat(path, " = \"", one_line(sweep.part(p).build_up()),
                                      "\", but [heat] is missing, expected it: a wall's "
                                      "temperature is computed"));
    }
    if (sweep.place().has_speed_m_s() && !has_funnel_plume(sweep))
      findings.add("place.speed_m_s",
                   "place.speed_m_s does not apply without [heat] or a funnel's [plume]");
    return;
  }
  const SectionCheck check(sweep.heat(), "heat", findings);
  const bool history = check.one_of("history", {"periodic", "days"});
  if (sweep.heat().has_history_days() && !(history && sweep.heat().history() == "days"))
    check.error("history_days", "does not apply, expected only with history = \"days\"");
  if (sweep.has_air() && sweep.air().model() != "atmosphere")
    findings.add("heat", absl::StrCat("[heat] needs air.model = \"atmosphere\", and air.model = \"",
                                      one_line(sweep.air().model()),
                                      "\": temperatures are computed under the embedded "
                                      "atmosphere's sky"));
  if (sweep.transport().has_sun() && !sweep.transport().sun())
    findings.add(
        "transport.sun",
        "transport.sun = false, but [heat] computes temperatures in the sun, expected true");
  if (!has_position(sweep))
    findings.add("heat",
                 "[heat] needs [place], expected latitude_deg, longitude_deg and heading_deg: "
                 "temperatures depend on where the sun stands");
  for (int p = 0; p < sweep.part_size(); ++p)
    if (sweep.part(p).has_build_up() && sweep.part(p).has_temperature_k()) {
      const std::string path = absl::StrCat("part[", p, "].build_up");
      findings.add(path, absl::StrCat(path,
                                      " stands beside temperature_k, which would be taken: "
                                      "expected only one of the two"));
    }
  bool any = false;
  for (int s = 0; s < sweep.season_size(); ++s) {
    const std::vector<int> parts = computed_parts(sweep, sweep.season(s));
    any = any || !parts.empty() || !computed_land(sweep, sweep.season(s)).empty();
    if (parts.empty()) continue;
    if (!sweep.season(s).has_temperature_field()) continue;
    const std::string path = absl::StrCat("season[", s, "].temperature_field");
    const int part = parts.front();
    findings.add(path, absl::StrCat(path, " and part[", part, "].build_up (\"",
                                    one_line(sweep.part(part).name()),
                                    "\") both say where temperatures come from, expected one of "
                                    "them in a season"));
  }
  if (!any && sweep.season_size() > 0)
    findings.add("heat", absl::StrCat("[heat], but the temperatures of all parts ",
                                      sweep.has_land() ? "and of all land " : "",
                                      "are stated or have no build_up, expected a part ",
                                      sweep.has_land() ? "or a [[land.material]] " : "",
                                      "with build_up and no temperature_k"));
}

void write_heat_defaults(schema::Sweep& sweep) {
  if (!sweep.has_heat()) return;
  schema::Heat& heat = *sweep.mutable_heat();
  if (!heat.has_history()) heat.set_history("periodic");
  if (heat.history() == "days" && !heat.has_history_days()) heat.set_history_days(3);
  if (!heat.has_step_minutes()) heat.set_step_minutes(10);
  if (!heat.has_tolerance_k()) heat.set_tolerance_k(0.01);
  if (!heat.has_rays()) heat.set_rays(256);
  if (!sweep.place().has_speed_m_s()) sweep.mutable_place()->set_speed_m_s(0);
}

void resolve_heat(const std::vector<SeasonGroup>& groups, schema::ResolvedSweep& resolved,
                  Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  if (!sweep.has_heat() || !findings.empty()) return;
  const int times = sweep.time_size();
  std::vector<std::string> known;
  std::vector<std::set<double>> instants;  // of each run
  for (const SeasonGroup& group : groups) {
    const schema::Season& season = sweep.season(group.season.front());
    const std::vector<int> parts = computed_parts(sweep, season),
                           land = computed_land(sweep, season);
    if ((parts.empty() && land.empty()) || !group.course) continue;
    const schema::Condition& first = resolved.condition(group.season.front() * times);
    schema::HeatRun run;
    run.set_season(season.name());
    *run.mutable_course() = message_of(*group.course);
    *run.mutable_surroundings() = first.surroundings();
    *run.mutable_weather() = first.weather();
    run.mutable_weather()->clear_modtran_text();
    run.mutable_weather()->clear_modtran_file_name();
    run.mutable_weather()->clear_cloud_cover();  // the course has it
    run.mutable_weather()->clear_cloud();
    // A cover that is uncertain may be moved from 0.
    if (sweep.uncertainty().has_cloud_cover() ||
        std::any_of(run.course().record().begin(), run.course().record().end(),
                    [](const schema::WeatherRecord& r) { return r.cloud_cover() > 0; }))
      *run.mutable_weather()->mutable_cloud() = cloud_layer(season, run.weather());
    *run.mutable_part_temperature_k() = first.part_temperature_k();
    // Those of a file are 0, and not to be computed; land does not depend on any.
    if (parts.empty())
      for (double& kelvin : *run.mutable_part_temperature_k()) kelvin = kUnusedK;
    for (const int p : parts) run.set_part_temperature_k(p, 0);
    if (!land.empty()) *run.mutable_land_temperature_k() = first.land_temperature_k();
    const std::string bytes = bytes_of(run);
    const auto same = std::find(known.begin(), known.end(), bytes);
    const auto index = static_cast<std::size_t>(same - known.begin());
    if (same == known.end()) {
      known.push_back(bytes);
      instants.emplace_back();
      *resolved.add_heat() = std::move(run);
    }
    instants[index].insert(group.unix_s.begin(), group.unix_s.end());
    for (const int s : group.season)
      for (int t = 0; t < times; ++t) {
        schema::Condition& condition = *resolved.mutable_condition(s * times + t);
        if (!land.empty()) condition.set_land_heat(static_cast<std::uint32_t>(index));
        if (parts.empty()) continue;
        schema::ConditionField& from = *condition.mutable_temperature_field();
        from.set_heat(static_cast<std::uint32_t>(index));
        for (const int p : parts) {
          from.add_part(static_cast<std::uint32_t>(p));
          condition.set_part_temperature_k(p, 0);
        }
      }
  }
  for (std::size_t i = 0; i < instants.size(); ++i)
    for (const double t : instants[i])
      resolved.mutable_heat(static_cast<int>(i))->add_time_utc(format_rfc3339_utc(utc_time(t)));
}

}  // namespace irsig
