#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/geo/sun.h"
#include "jobs/consistency/check_weather.h"
#include "jobs/text/nearest_name.h"
#include "jobs/text/sweep_places.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {
namespace {

// Days of a year without a leap day: a day more or less decides nothing here.
constexpr std::array<int, 12> kDaysBefore = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};

int day_of_year(int month, int day) {
  return kDaysBefore[static_cast<std::size_t>(month - 1)] + day;
}

// The upper limb of the sun, raised by refraction, touches the horizon.
constexpr double kSunriseDeg = -0.833;
// Down to here the air scatters sunlight that rows count (core/environment).
constexpr double kTwilightEndDeg = -6;

// From the first day of the meteorological season to the last of the astronomical one, in the
// north.
struct NamedSeason {
  const char* name;
  int first_day, last_day;  // of the year; winter goes across its end
  const char* dates;
  const char* southern_dates;
};
constexpr std::array<NamedSeason, 5> kSeasons = {
    {{"winter", 335, 80, "December 1 to March 21", "June 1 to September 21"},
     {"spring", 60, 173, "March 1 to June 22", "September 1 to December 22"},
     {"summer", 152, 267, "June 1 to September 24", "December 1 to March 24"},
     {"autumn", 244, 356, "September 1 to December 22", "March 1 to June 22"},
     {"fall", 244, 356, "September 1 to December 22", "March 1 to June 22"}}};

// Days from a day to the nearest of the season; 0 inside.
int days_outside(const NamedSeason& season, int day) {
  const auto around = [](int from, int to) { return ((to - from) % 365 + 365) % 365; };
  const int length = around(season.first_day, season.last_day);
  const int since = around(season.first_day, day);
  return since <= length ? 0 : std::min(since - length, 365 - since);
}

std::set<std::string> words_of(const std::string& name) {
  std::set<std::string> words;
  std::string word;
  for (const char c : absl::AsciiStrToLower(name) + " ") {
    if (absl::ascii_isalpha(static_cast<unsigned char>(c))) {
      word += c;
    } else if (!word.empty()) {
      words.insert(word);
      word.clear();
    }
  }
  return words;
}

void check_season_name(schema::ResolvedSweep& resolved, int s, Findings& findings) {
  const schema::Season& season = resolved.sweep().season(s);
  const schema::Place& place = resolved.sweep().place();
  const std::set<std::string> words = words_of(season.name());
  const bool south = place.latitude_deg() < 0;
  int day = day_of_year(std::atoi(season.date().substr(5, 2).c_str()),
                        std::atoi(season.date().substr(8).c_str()));
  if (south) day = (day + 182) % 365;
  for (const std::string& word : words) {
    const std::vector<std::string> known = {"winter", "spring", "summer", "autumn"};
    if (word.size() < 5 || std::find(known.begin(), known.end(), word) != known.end()) continue;
    const std::string path = absl::StrCat("season[", s, "].name");
    if (nearest_name(word, known))
      warn_season(resolved, s, path,
                  absl::StrCat(path, " = \"", season.name(), "\": ", suggestion(word, known),
                               " As it stands its dates are not checked against a season"),
                  findings);
  }
  for (const NamedSeason& named : kSeasons) {
    if (!words.contains(named.name)) continue;
    const int outside = days_outside(named, day);
    if (outside == 0) continue;
    const std::string path = absl::StrCat("season[", s, "].name");
    const std::string what =
        absl::StrCat(path, " = \"", season.name(), "\" and date = ", season.date(),
                     " at place.latitude_deg = ", place.latitude_deg());
    const std::string expected = absl::StrCat(named.name, " lasts from ",
                                              south ? named.southern_dates : named.dates, " there");
    if (outside > 31) {
      findings.add(path, absl::StrCat(what, " contradict each other: ", expected));
    } else {
      warn_season(resolved, s, path,
                  absl::StrCat(what, " are ", outside, " days apart: ", expected), findings);
    }
  }
}

// Where the time of a condition is written, and how.
std::string time_path(const schema::Sweep& sweep, const schema::Condition& condition) {
  const auto season = static_cast<int>(condition.season_index());
  return sweep.season(season).has_time() ? absl::StrCat("season[", season, "].time")
                                         : absl::StrCat("time[", condition.time_index(), "]");
}
std::string time_text(const schema::Sweep& sweep, const schema::Condition& condition) {
  const schema::Season& season = sweep.season(static_cast<int>(condition.season_index()));
  return season.has_time() ? season.time() : sweep.time(static_cast<int>(condition.time_index()));
}

void check_hour_in_name(const schema::ResolvedSweep& resolved, const schema::Condition& condition,
                        double elevation_deg, Findings& findings) {
  const std::set<std::string> words = words_of(condition.season());
  if (words.contains("polar") || words.contains("white") || words.contains("sun")) return;
  const bool night = words.contains("night") || words.contains("midnight");
  const bool day = words.contains("noon") || words.contains("midday") || words.contains("daytime");
  if (!(night && elevation_deg > 0) && !(day && elevation_deg < kSunriseDeg)) return;
  const std::string path = absl::StrCat("season[", condition.season_index(), "].name");
  findings.add(path, absl::StrCat(path, " = \"", condition.season(), "\" contradicts ",
                                  time_path(resolved.sweep(), condition), " = \"",
                                  time_text(resolved.sweep(), condition), "\": the sun is then ",
                                  std::abs(std::round(elevation_deg * 10) / 10), " deg ",
                                  elevation_deg > 0 ? "above" : "below", " the horizon"));
}

// An offset from UTC that is another longitude's: no zone of the world is 3 hours off its sun.
void check_offset(schema::ResolvedSweep& resolved, const schema::Condition& condition,
                  Findings& findings) {
  constexpr double kFurthestH = 3;
  const schema::Sweep& sweep = resolved.sweep();
  const std::string text = time_text(sweep, condition);
  const std::size_t sign = text.find_last_of("+-");
  if (sign == std::string::npos || text.size() != sign + 6) return;  // "Z": no clock's time
  const double offset_h = (text[sign] == '-' ? -1 : 1) * (std::atof(text.c_str() + sign + 1) +
                                                          std::atof(text.c_str() + sign + 4) / 60);
  const double longitude_deg = sweep.place().longitude_deg();
  const double ahead_h = std::remainder(offset_h - longitude_deg / 15, 24);
  if (offset_h == 0 || std::abs(ahead_h) <= kFurthestH) return;
  const std::string path = time_path(sweep, condition);
  warn_season(resolved, static_cast<int>(condition.season_index()), path,
              absl::StrCat(path, " = \"", text, "\" is ", std::abs(std::round(10 * ahead_h) / 10),
                           " h ", ahead_h > 0 ? "ahead of" : "behind",
                           " the sun at place.longitude_deg = ", longitude_deg,
                           ": east of Greenwich is positive, and so are the offsets there"),
              findings);
}

// Waves that stand in the sun of others are left out; of the glitter below this their share is a
// fifth and more (glint_model_relative, 5 m/s).
constexpr double kGrazingGlitterDeg = 5;

void check_low_sun(const schema::Sweep& sweep, schema::Condition& condition, double elevation_deg,
                   Findings& findings) {
  if (!sweep.transport().sun() || !condition.has_weather() ||
      !is_rough_sea(condition.surroundings()))
    return;
  if (elevation_deg < kSunriseDeg || elevation_deg > kGrazingGlitterDeg) return;
  const std::string path = time_path(sweep, condition);
  condition.add_warning(findings.odd(
      path,
      absl::StrCat(
          path, ": the sun stands at ", std::round(elevation_deg * 10) / 10,
          " deg: its glitter lacks the shadows of waves; contrast_model_error_w_sr holds them")));
}

// The sun's largest elevation on the day of a condition, to 0.1 deg.
double highest_sun_deg(const schema::Place& place, const schema::Condition& condition) {
  double highest_deg = -90;
  schema::Condition hour = condition;
  const std::string date = condition.time_utc().substr(0, 10);
  for (int h = 0; h < 24; ++h) {
    for (const char* minute : {"00", "20", "40"}) {
      hour.set_time_utc(absl::StrCat(date, "T", h < 10 ? "0" : "", h, ":", minute, ":00Z"));
      highest_deg = std::max(highest_deg, sun_there(place, hour).elevation_deg);
    }
  }
  return highest_deg;
}

// Sunlight that is asked for and never comes.
void check_sun_rises(schema::ResolvedSweep& resolved, double highest_deg, Findings& findings) {
  const schema::Place place = resolved.sweep().place();
  const int times = resolved.sweep().time_size();
  bool polar_night = false;
  for (int s = 0; s < resolved.sweep().season_size(); ++s) {
    const double of_day_deg = highest_sun_deg(place, resolved.condition(s * times));
    if (of_day_deg > kSunriseDeg) continue;
    polar_night = true;
    const std::string path = absl::StrCat("season[", s, "].date");
    warn_season(resolved, s, path,
                absl::StrCat(path, " = ", resolved.sweep().season(s).date(),
                             " is polar night at place.latitude_deg = ", place.latitude_deg(),
                             ": transport.sun = true, but the sun stays ",
                             std::round(-of_day_deg * 10) / 10, " deg below the horizon all day"),
                findings);
  }
  if (polar_night || highest_deg > kTwilightEndDeg) return;
  for (int s = 0; s < resolved.sweep().season_size(); ++s)
    warn_season(resolved, s, "transport.sun",
                absl::StrCat("transport.sun = true, but the sun is below the horizon at every time "
                             "of this sweep, by ",
                             std::round(-highest_deg * 10) / 10, " deg or more"),
                findings);
}

}  // namespace

void warn_season(schema::ResolvedSweep& resolved, int season_index, const std::string& key,
                 const std::string& what, Findings& findings) {
  const std::string warning = findings.odd(key, what);
  for (schema::Condition& condition : *resolved.mutable_condition()) {
    if (static_cast<int>(condition.season_index()) != season_index) continue;
    const auto& known = condition.warning();
    if (std::find(known.begin(), known.end(), warning) == known.end())
      condition.add_warning(warning);
  }
}

SunThere sun_there(const schema::Place& place, const schema::Condition& condition) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto time = parse_rfc3339(condition.time_utc());
  if (!time.ok()) return {0, kUnknown};  // resolve_conditions wrote it
  const auto sun =
      sun_position(*time, place.latitude_deg(), place.longitude_deg(), place.height_m());
  return {day_of_year(time->month, time->day), sun.ok() ? 90 - sun->zenith_deg : kUnknown};
}

void check_calendar(schema::ResolvedSweep& resolved, Findings& findings) {
  if (!has_position(resolved.sweep())) return;
  for (int s = 0; s < resolved.sweep().season_size(); ++s) check_season_name(resolved, s, findings);
  double highest_deg = -90;
  for (schema::Condition& condition : *resolved.mutable_condition()) {
    const double elevation_deg = sun_there(resolved.sweep().place(), condition).elevation_deg;
    check_low_sun(resolved.sweep(), condition, elevation_deg, findings);
    check_offset(resolved, condition, findings);
    highest_deg = std::max(highest_deg, elevation_deg);
    check_hour_in_name(resolved, condition, elevation_deg, findings);
  }
  if (resolved.sweep().transport().sun()) check_sun_rises(resolved, highest_deg, findings);
}

void check_weather(schema::ResolvedSweep& resolved, Findings& findings) {
  check_calendar(resolved, findings);
  check_units(resolved, findings);
  check_surfaces(resolved, findings);
}

}  // namespace irsig
