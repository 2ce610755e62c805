#include "jobs/season_course.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/weather_file.h"
#include "jobs/files/weather_files.h"
#include "jobs/resolve.h"
#include "jobs/resolve_cloud.h"
#include "jobs/resolve_plume.h"
#include "jobs/text/number_bounds.h"

namespace irsig {
namespace {

constexpr double kDayS = 86400;
constexpr double kHistoryDays = 3;  // of history = "days"; docs/reference/keys/season.md
constexpr double kWarmestHour = 15;

// Returns the properties that the seasons of one group have in common, as bytes.
std::string alike(schema::Season season) {
  season.clear_name();
  season.clear_time();
  const std::map<std::string, double> parts(season.part_temperature_k().begin(),
                                            season.part_temperature_k().end());
  const std::map<std::string, double> land(season.land_temperature_k().begin(),
                                           season.land_temperature_k().end());
  season.clear_part_temperature_k();  // in an order of its own
  season.clear_land_temperature_k();
  std::string key = season.SerializeAsString();
  for (const auto& [part, k] : parts)
    absl::StrAppend(&key, "\n", part, " ", absl::Hex(std::bit_cast<std::uint64_t>(k)));
  for (const auto& [material, k] : land)
    absl::StrAppend(&key, "\nland ", material, " ", absl::Hex(std::bit_cast<std::uint64_t>(k)));
  return key;
}

bool repeats(const schema::Sweep& sweep) {
  return sweep.has_heat() && sweep.heat().history() != "days";
}

class CourseReader {
 public:
  CourseReader(const SweepFile& file, Findings& findings)
      : file_(file), sweep_(file.sweep), findings_(findings) {}

  void read(SeasonGroup& group) {
    const int s = group.season.front();
    const schema::Season& season = sweep_.season(s);
    const std::string path = absl::StrCat("season[", s, "]");
    if (season.has_weather_file()) {
      of_file(season, path, group);
    } else if (season.has_day() || sweep_.has_heat()) {
      of_day(season, path, group);
    }
  }

 private:
  [[nodiscard]] WeatherPlace place() const {
    return {sweep_.place().latitude_deg(), sweep_.place().longitude_deg(),
            sweep_.place().height_m()};
  }

  [[nodiscard]] static UtcTime date_of(const schema::Season& season) {
    const std::string& date = season.date();
    return {std::atoi(date.substr(0, 4).c_str()),
            std::atoi(date.substr(5, 2).c_str()),
            std::atoi(date.substr(8).c_str()),
            0,
            0,
            0};
  }
  [[nodiscard]] double solar_midnight(const schema::Season& season) const {
    const UtcTime date = date_of(season);
    return solar_midnight_unix_s(date.year, date.month, date.day, sweep_.place().longitude_deg());
  }

  bool has_place(const std::string& key) {
    if (has_position(sweep_)) return true;
    findings_.add(key, absl::StrCat(key,
                                    ": [place] is missing, expected latitude_deg, "
                                    "longitude_deg and heading_deg: hours of a day are those "
                                    "of a place"));
    return false;
  }

  const WeatherFile* file_named(const std::string& path, const std::string& name) {
    const auto known = read_.find(name);
    if (known != read_.end()) return &known->second;
    const auto text = file_.content.find(weather_file_key(name));
    if (text == file_.content.end()) {
      findings_.add(path, path + " was not read");
      return nullptr;
    }
    auto parsed = read_weather_file(text->second, one_line(name));
    if (!parsed.ok()) {
      add_problems(path, parsed.status());
      return nullptr;
    }
    return &read_.emplace(name, *std::move(parsed)).first->second;
  }

  // Adds the problems of a file that the key names.
  void add_problems(const std::string& path, const absl::Status& status) {
    for (const Problem& problem : problems_of(status)) {
      const std::string what = absl::StrCat(path, ": ", problem.text);
      if (problem.place.empty())
        findings_.add(path, what);
      else
        findings_.add_at(problem.place, what);
    }
  }

  // Warns of times outside of a day that repeats.
  static void warn_of_other_days(const std::string& path, const schema::Season& season,
                                 double from_unix_s, SeasonGroup& group) {
    for (const double t : group.unix_s)
      if (t < from_unix_s || t > from_unix_s + kDayS) {
        group.warning.push_back(
            {"", path,
             absl::StrCat(path, ": ", format_rfc3339_utc(utc_time(t)), " is not within ",
                          season.date(),
                          " at the place: the same hour of that day stands for it")});
        return;
      }
  }

  void of_file(const schema::Season& season, const std::string& of, SeasonGroup& group) {
    const std::string path = of + ".weather_file";
    if (!has_place(path)) return;
    const WeatherFile* file = file_named(path, season.weather_file());
    if (file == nullptr) return;
    const auto has = [&](WeatherQuantity q) { return file->has[static_cast<std::size_t>(q)]; };
    const auto both = [&](const char* key, bool stated, WeatherQuantity q) {
      if (stated && has(q))
        findings_.add(absl::StrCat(of, ".", key),
                      absl::StrCat(of, ".", key, " does not apply: the weather file has it"));
    };
    both("wind_from_deg", season.has_wind_from_deg(), WeatherQuantity::kWindFrom);
    both("cloud_cover", season.has_cloud_cover(), WeatherQuantity::kCloudCover);
    const bool of_plume = has_funnel_plume(sweep_);
    if ((sweep_.has_heat() || of_plume) && !has(WeatherQuantity::kWindFrom) &&
        !season.has_wind_from_deg())
      findings_.add(
          of + ".wind_from_deg",
          absl::StrCat(of, ".wind_from_deg is missing (and a column wind_from_deg in \"",
                       one_line(season.weather_file()),
                       "\" too), expected where the "
                       "wind comes from: ",
                       of_plume ? "it bends the funnel's plume" : "temperatures are computed"));
    if (!findings_.empty()) return;
    CourseWanted wanted;
    wanted.place = place();
    wanted.radiation = sweep_.has_heat();
    wanted.wind_direction = of_plume;
    if (season.has_wind_from_deg()) wanted.wind_from_deg = season.wind_from_deg();
    wanted.cloud_cover = stated_cloud_cover(season);
    wanted.cloud_cover_wins = season.cloud_size() > 0;
    wanted.periodic = repeats(sweep_);
    if (wanted.periodic) {
      // In the file's own hours, where it has any.
      wanted.from_unix_s = file->any_year
                               ? unix_seconds(date_of(season)) - 3600 * file->utc_offset_h
                               : solar_midnight(season);
      wanted.to_unix_s = wanted.from_unix_s + kDayS;
      warn_of_other_days(path, season, wanted.from_unix_s, group);
    } else {
      const double days = !sweep_.has_heat()                 ? 0
                          : sweep_.heat().has_history_days() ? sweep_.heat().history_days()
                                                             : kHistoryDays;
      wanted.from_unix_s = group.unix_s.front() - days * kDayS;
      wanted.to_unix_s = group.unix_s.back();
    }
    auto course = course_of(*file, wanted);
    if (!course.ok()) return add_problems(path, course.status());
    group.course = std::move(course->course);
    for (const std::string& warning : course->warning)
      group.warning.push_back({"", path, absl::StrCat(path, ": ", warning)});
  }

  // A day that is stated, or one weather all day.
  void of_day(const schema::Season& season, const std::string& of, SeasonGroup& group) {
    const std::string path = season.has_day() ? of + ".day" : of;
    if (!has_place(path)) return;
    if (sweep_.has_heat() && sweep_.heat().history() == "days") {
      findings_.add("heat.history",
                    absl::StrCat("heat.history = \"days\", but ", of,
                                 " has no weather_file with the days before, expected "
                                 "\"periodic\" or a weather_file"));
      return;
    }
    if (sweep_.has_heat() && !season.has_wind_from_deg()) {
      findings_.add(of + ".wind_from_deg",
                    absl::StrCat(of,
                                 ".wind_from_deg is missing, expected where the wind comes "
                                 "from, clockwise from north: temperatures are computed"));
      return;
    }
    StatedDay day{.air_min_k = season.air_temperature_k(),
                  .air_max_k = season.air_temperature_k(),
                  .warmest_hour = kWarmestHour,
                  .dew_point_k = 0,
                  .pressure_pa = season.pressure_pa(),
                  .wind_m_s = season.wind_speed_m_s(),
                  .wind_from_deg = season.wind_from_deg(),
                  .cloud_cover = stated_cloud_cover(season).value_or(0)};
    if (season.has_day()) {
      day.air_min_k = season.day().air_temperature_min_k();
      day.air_max_k = season.day().air_temperature_max_k();
      if (season.day().has_warmest_hour()) day.warmest_hour = season.day().warmest_hour();
      day.dew_point_k = season.day().dew_point_k();
    } else {
      day.dew_point_k =
          std::min(day.air_min_k, dew_point_k(season.relative_humidity_percent() / 100 *
                                              vapour_pressure_pa(season.air_temperature_k())));
    }
    if (sweep_.has_heat()) warn_of_other_days(path, season, solar_midnight(season), group);
    auto course = day_course(day, solar_midnight(season));
    if (course.ok())
      group.course = *std::move(course);
    else
      findings_.add(path, absl::StrCat(path, ": ", std::string(course.status().message())));
  }

  const SweepFile& file_;
  const schema::Sweep& sweep_;
  Findings& findings_;
  std::map<std::string, WeatherFile> read_;
};

}  // namespace

std::vector<SeasonGroup> season_groups(const SweepFile& file,
                                       const std::vector<std::vector<UtcTime>>& instants,
                                       Findings& findings) {
  std::vector<SeasonGroup> groups;
  std::map<std::string, std::size_t> of_key;
  for (int s = 0; s < file.sweep.season_size(); ++s) {
    const auto [at, is_new] = of_key.try_emplace(alike(file.sweep.season(s)), groups.size());
    if (is_new) groups.emplace_back();
    SeasonGroup& group = groups[at->second];
    group.season.push_back(s);
    for (const UtcTime& t : instants[static_cast<std::size_t>(s)])
      group.unix_s.push_back(unix_seconds(t));
  }
  CourseReader reader(file, findings);
  for (SeasonGroup& group : groups) {
    std::sort(group.unix_s.begin(), group.unix_s.end());
    group.unix_s.erase(std::unique(group.unix_s.begin(), group.unix_s.end()), group.unix_s.end());
    reader.read(group);
  }
  return groups;
}

schema::Season with_weather_of(const WeatherCourse& course, double unix_s,
                               const schema::Season& season, int season_index, Findings& findings) {
  const WeatherRecord now = weather_at(course, unix_s);
  const double percent =
      std::min(100.0, 100 * vapour_pressure_pa(now.dew_point_k) / vapour_pressure_pa(now.air_k));
  const std::string of = absl::StrCat("season[", season_index, "].");
  const char* from = season.has_weather_file() ? "weather_file" : season.has_day() ? "day" : "";
  schema::Season out = season;
  // The course has it of a statement of the season, or instead of one.
  const auto take = [&](const char* key, bool stated, double said, double has, double slack) {
    if (!stated || std::abs(said - has) <= slack) return;
    findings.add(of + key,
                 absl::StrCat(of, key, " = ", number_text(said), ", but ", of, from, " has ",
                              absl::SixDigits(has), " at ", format_rfc3339_utc(utc_time(unix_s)),
                              ", expected one of the two"));
  };
  take("air_temperature_k", season.has_air_temperature_k(), season.air_temperature_k(), now.air_k,
       0.05);
  take("relative_humidity_percent", season.has_relative_humidity_percent(),
       season.relative_humidity_percent(), percent, 0.5);
  take("pressure_pa", season.has_pressure_pa(), season.pressure_pa(), now.pressure_pa, 50);
  take("wind_speed_m_s", season.has_wind_speed_m_s(), season.wind_speed_m_s(), now.wind_m_s, 0.05);
  if (!season.has_air_temperature_k()) out.set_air_temperature_k(now.air_k);
  if (!season.has_relative_humidity_percent()) out.set_relative_humidity_percent(percent);
  if (!season.has_pressure_pa()) out.set_pressure_pa(now.pressure_pa);
  if (!season.has_wind_speed_m_s()) out.set_wind_speed_m_s(now.wind_m_s);
  if (!season.has_wind_from_deg()) out.set_wind_from_deg(now.wind_from_deg);
  const NumberBounds& wind = bounds_of("Season.wind_speed_m_s");
  if (now.wind_m_s > wind.most)
    findings.add(of + from, absl::StrCat(of, from, " has a wind of ", absl::SixDigits(now.wind_m_s),
                                         " m/s at ", format_rfc3339_utc(utc_time(unix_s)),
                                         ", expected ", text_of(wind)));
  return out;
}

}  // namespace irsig
