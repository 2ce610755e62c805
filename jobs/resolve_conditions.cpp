#include <cctype>
#include <cstdlib>
#include <map>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/geo/sun.h"
#include "core/spectral/solar.h"
#include "jobs/resolve.h"
#include "jobs/resolve_cloud.h"
#include "jobs/resolve_heat.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_plume.h"
#include "jobs/season_course.h"
#include "jobs/text/time_of_day.h"

namespace irsig {
namespace {

bool all_digits(std::string_view text) {
  for (const char c : text) {
    if (!std::isdigit(static_cast<unsigned char>(c))) return false;
  }
  return !text.empty();
}

bool is_date(const std::string& date) {
  return date.size() == 10 && date[4] == '-' && date[7] == '-' && all_digits(date.substr(0, 4)) &&
         all_digits(date.substr(5, 2)) && all_digits(date.substr(8)) &&
         parse_rfc3339(date + "T00:00:00Z").ok();
}

void check_seasons(const schema::Sweep& sweep, Findings& findings) {
  if (sweep.season_size() == 0) {
    findings.add("season",
                 "[[season]] is missing, expected one or more seasons with name and date");
    return;
  }
  // Conditions of a table may share a name (condition_table.h).
  if (!sweep.season(0).has_time()) (void)check_names(sweep.season(), "season", findings);
  for (int i = 0; i < sweep.season_size(); ++i) {
    const schema::Season& season = sweep.season(i);
    const SectionCheck check(season, absl::StrCat("season[", i, "]"), findings);
    if (season.has_time() && !is_one_line(season.name()))
      check.error("name", "has control characters, expected a plain name");
    else if (season.has_time() && is_formula(season.name()))
      check.error("name", absl::StrCat("= \"", season.name(), "\": ", kFormulaName));
    check.require({"date"}, "expected a date: 2025-12-21");
    if (season.has_date() && !is_date(season.date())) {
      check.error("date", absl::StrCat("= \"", season.date(),
                                       "\", expected a date of the calendar: 2025-12-21"));
    } else if (season.has_date() &&
               (season.date().substr(0, 4) < "1900" || season.date().substr(0, 4) > "2100")) {
      check.error("date", absl::StrCat("= ", season.date(), ", expected a year from 1900 to 2100"));
    }
  }
}

int month_of(const std::string& date) { return std::atoi(date.substr(5, 2).c_str()); }

// The instant of each season's date at each time, [season][time]; nullopt where the file is wrong.
std::vector<std::vector<std::optional<UtcTime>>> check_times(const schema::Sweep& sweep,
                                                             Findings& findings) {
  std::vector<std::vector<std::optional<UtcTime>>> instants(
      static_cast<std::size_t>(sweep.season_size()));
  // The first season with this name at this instant: conditions of a table may share a name.
  std::map<std::pair<std::string, std::string>, int> seen;
  if (sweep.time_size() == 0) {
    findings.add("time",
                 "time is missing, expected one or more times of day: time = [\"10:30+09:00\"]");
  }
  for (int t = 0; t < sweep.time_size() && sweep.season_size() == 0; ++t)
    if (const TimeOfDay time = time_of_day(sweep.time(t)); !time.wrong.empty())
      findings.add(absl::StrCat("time[", t, "]"),
                   absl::StrCat("time[", t, "] = \"", sweep.time(t), "\" ", time.wrong));
  for (int s = 0; s < sweep.season_size(); ++s) {
    const schema::Season& season = sweep.season(s);
    auto& row = instants[static_cast<std::size_t>(s)];
    std::map<std::string, int> at;  // by the instant
    for (int t = 0; t < sweep.time_size(); ++t) {
      row.emplace_back();
      const std::string path =
          season.has_time() ? absl::StrCat("season[", s, "].time") : absl::StrCat("time[", t, "]");
      const std::string& written = season.has_time() ? season.time() : sweep.time(t);
      const TimeOfDay time = time_of_day(written);
      if (!time.wrong.empty()) {
        findings.add(path, absl::StrCat(path, " = \"", written, "\" ", time.wrong));
        continue;
      }
      if (!is_date(season.date())) continue;
      const absl::StatusOr<UtcTime> instant =
          parse_rfc3339(absl::StrCat(season.date(), "T", time.text));
      if (!instant.ok()) {
        findings.add(path, absl::StrCat(path, " = \"", written, "\" is no time on ", season.date(),
                                        ": ", instant.status().message()));
        continue;
      }
      const auto [earlier, is_first] = at.try_emplace(format_rfc3339_utc(*instant), t);
      if (!is_first)
        findings.add(path, absl::StrCat(path, " = \"", written, "\" is the same instant as time[",
                                        earlier->second, "], expected different times"));
      row.back() = *instant;
      const auto [other, is_new] =
          seen.try_emplace({season.name(), format_rfc3339_utc(*instant)}, s);
      if (!is_new && season.has_time())
        findings.add(
            absl::StrCat("season[", s, "].name"),
            absl::StrCat("season[", s, "] is \"", season.name(), "\" at the same time as season[",
                         other->second, "], expected a name of its own"));
    }
  }
  return instants;
}

// Writes the sun's irradiance of one condition: as the season states it, else E490 at the sun's
// distance.
void resolve_sun(const schema::Sweep& sweep, int season_index, const UtcTime& utc,
                 schema::Condition& condition, Findings& findings) {
  const schema::Season& season = sweep.season(season_index);
  if (!sweep.transport().sun()) return;
  const schema::Place& place = sweep.place();
  const absl::StatusOr<SunPosition> sun =
      sun_position(utc, place.latitude_deg(), place.longitude_deg(), place.height_m());
  if (!sun.ok()) {
    const std::string path = absl::StrCat("season[", season_index, "].date");
    findings.add(path, absl::StrCat(path, " has no sun position: ", sun.status().message()));
  } else if (season.has_sun_irradiance_w_m2()) {
    condition.set_sun_irradiance_w_m2(season.sun_irradiance_w_m2());
  } else {
    condition.set_sun_irradiance_w_m2(kSolarConstantWM2 / (sun->distance_au * sun->distance_au));
    condition.set_sun_irradiance_from_distance(true);
  }
}

}  // namespace

void check_place(const schema::Sweep& sweep, Findings& findings) {
  if (!sweep.has_place()) {
    if (sweep.transport().sun()) {
      findings.add("place",
                   "[place] is missing, expected latitude_deg, longitude_deg and heading_deg: the "
                   "sun is on");
    }
    return;
  }
  const SectionCheck check(sweep.place(), "place", findings);
  // Where neither the sun nor the profile depends on the place, a height alone will do.
  const schema::Place& place = sweep.place();
  if (place.has_above_surface_m() && !sweep.transport().sun() && !place.has_latitude_deg() &&
      !place.has_longitude_deg() && !place.has_heading_deg() && !place.has_speed_m_s())
    return;
  check.require({"latitude_deg"}, "expected degrees north of the equator, -90 to 90");
  check.require({"longitude_deg"}, "expected degrees east of Greenwich, -180 to 180");
  check.require({"heading_deg"},
                "expected the bow's direction in degrees clockwise from true north");
}

void resolve_conditions(const SweepFile& file, schema::ResolvedSweep& resolved,
                        Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  check_place(sweep, findings);
  check_air(sweep, findings);
  check_seasons(sweep, findings);
  const auto instants = check_times(sweep, findings);
  const auto surroundings = resolve_surroundings(sweep, findings);
  for (int s = 0; s < sweep.season_size(); ++s)
    check_season_air(sweep, s, surroundings[static_cast<std::size_t>(s)], findings);
  const double count = static_cast<double>(sweep.season_size()) * sweep.time_size();
  if (count > kMostConditions) {
    findings.add("time", absl::StrCat("time and season make ", count,
                                      " conditions, expected at most ", kMostConditions));
  }
  if (!findings.empty()) return;

  std::vector<std::vector<UtcTime>> known;
  for (const auto& row : instants) {
    auto& times = known.emplace_back();
    for (const auto& instant : row) times.push_back(*instant);
  }
  const std::vector<SeasonGroup> groups = season_groups(file, known, findings);
  std::vector<const SeasonGroup*> group_of(static_cast<std::size_t>(sweep.season_size()));
  for (const SeasonGroup& group : groups)
    for (const int s : group.season) group_of[static_cast<std::size_t>(s)] = &group;
  if (!findings.empty()) return;

  const auto fields = resolve_temperature_fields(file);
  std::vector<PlumeWeather> wind;  // [condition]
  for (int s = 0; s < sweep.season_size(); ++s) {
    const schema::Season& season = sweep.season(s);
    const SeasonGroup& group = *group_of[static_cast<std::size_t>(s)];
    const bool atmosphere = sweep.air().model() == "atmosphere";
    schema::Weather weather;
    if (atmosphere && !group.course)
      weather = resolve_weather(file, s, season, month_of(season.date()), findings);
    for (int t = 0; t < sweep.time_size(); ++t) {
      const UtcTime& utc = *instants[static_cast<std::size_t>(s)][static_cast<std::size_t>(t)];
      schema::Condition& condition = *resolved.add_condition();
      condition.set_season_index(static_cast<std::uint32_t>(s));
      condition.set_time_index(static_cast<std::uint32_t>(t));
      condition.set_season(season.name());
      condition.set_time_utc(format_rfc3339_utc(utc));
      for (const schema::Part& part : sweep.part()) {
        const auto stated = season.part_temperature_k().find(part.name());
        condition.add_part_temperature_k(
            stated != season.part_temperature_k().end() ? stated->second : part.temperature_k());
      }
      take_land_temperatures(sweep, season, condition);
      take_temperature_field(fields, sweep, season, condition);
      *condition.mutable_surroundings() = surroundings[static_cast<std::size_t>(s)];
      resolve_sun(sweep, s, utc, condition, findings);
      if (sweep.air().model() == "homogeneous")
        condition.set_air_temperature_k(season.air_temperature_k());
      schema::Season now = season;
      if (atmosphere && group.course) {
        now = with_weather_of(*group.course, unix_seconds(utc), season, s, findings);
        weather = resolve_weather(file, s, now, month_of(season.date()), findings);
        weather.set_cloud_cover(weather_at(*group.course, unix_seconds(utc)).cloud_cover);
      }
      if (atmosphere && !group.course)
        weather.set_cloud_cover(stated_cloud_cover(season).value_or(0));
      wind.push_back({now.wind_speed_m_s(), now.wind_from_deg()});
      if (atmosphere) {
        resolve_cloud(season, s, sweep.uncertainty().has_cloud_cover(), weather, condition,
                      findings);
        condition.set_air_temperature_k(weather.air_temperature_k());
        *condition.mutable_weather() = weather;
      }
      for (const Problem& warning : group.warning)
        condition.add_warning(findings.odd(warning.key, warning.text));
    }
  }
  resolve_heat(groups, resolved, findings);
  resolve_plumes(file, wind, resolved, findings);
}

}  // namespace irsig
