#include "jobs/consistency/check_weather.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/atmosphere/air_column.h"
#include "core/atmosphere/air_profile.h"
#include "core/thermal/sky_of_air.h"
#include "jobs/text/sweep_places.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {
namespace {

// Numbers that people think of in degrees Celsius.
std::string perhaps_celsius(double k) {
  return k >= -60 && k <= 100
             ? absl::StrCat(" (is it in degrees Celsius? ", k, " C are ", k + 273.15, " K)")
             : "";
}

// One season of a sweep with the embedded atmosphere.
class SeasonGate {
 public:
  // alone: false checks all conditions at once, true the one condition that has weather of its own.
  SeasonGate(schema::ResolvedSweep& resolved, int s, int time, bool alone, Findings& findings)
      : resolved_(resolved),
        sweep_(resolved.sweep()),
        season_(sweep_.season(s)),
        condition_(*resolved.mutable_condition(s * sweep_.time_size() + time)),
        weather_(condition_.weather()),
        findings_(findings),
        index_(s),
        alone_(alone) {}

  void check() {
    check_profile();
    check_pressure();
    check_humidity();
    check_aerosol();
    if (condition_.surroundings().kind() == "sea") check_sea();
    if (condition_.surroundings().kind() == "ground") check_ground();
    for (int p = 0; p < sweep_.part_size(); ++p) check_part(p);
  }

 private:
  // A key, and its name in messages: for an hour of a weather file, more than the key.
  struct Name {
    std::string key, text;
  };

  void contradiction(const Name& of, const std::string& what) {
    findings_.add(of.key, absl::StrCat(of.text, " ", what));
  }
  void contradiction(const std::string& key, const std::string& what) {
    contradiction(Name{key, key}, what);
  }
  void odd(const Name& of, const std::string& what) {
    const std::string warning = absl::StrCat(of.text, " ", what);
    if (!alone_)
      warn_season(resolved_, index_, of.key, warning, findings_);
    else
      condition_.add_warning(findings_.odd(of.key, warning));
  }
  void odd(const std::string& key, const std::string& what) { odd(Name{key, key}, what); }

  // Where a key of this season is stated: by the season, or by the sweep's own table.
  [[nodiscard]] std::string of_season(const std::string& key) const {
    return absl::StrCat("season[", index_, "].", key);
  }
  // Returns where surface weather is stated, which a weather file or a day may state instead.
  [[nodiscard]] Name of_surface(const std::string& key, bool stated) const {
    if (!alone_ || stated) return {of_season(key), of_season(key)};
    const std::string source = of_season(season_.has_weather_file() ? "weather_file" : "day");
    return {source, absl::StrCat(source, " at ", condition_.time_utc(), ": ", key)};
  }
  [[nodiscard]] std::string of_surroundings(const std::string& key, bool in_season) const {
    return in_season ? of_season("surroundings." + key) : "surroundings." + key;
  }
  // How the air's temperature came to be, for messages.
  [[nodiscard]] std::string air_text() const {
    return weather_.surface_stated()
               ? absl::StrCat("air_temperature_k = ", weather_.air_temperature_k())
               : absl::StrCat("the profile's air at the surface, ", weather_.air_temperature_k(),
                              " K");
  }

  // A profile that somebody chose, against date and place.
  void check_profile() {
    const bool own = season_.has_profile();
    if (own || (sweep_.air().has_profile() && !season_.has_profile_file()))
      check_profile_name(own ? of_season("profile") : "air.profile");
    if (!weather_.surface_stated()) return;
    schema::Weather unbent = weather_;
    unbent.set_surface_stated(false);
    const auto profile = profile_surface_k(unbent);
    const double warmer_k = weather_.air_temperature_k() - profile;
    if (std::abs(warmer_k) > 25)
      odd(of_surface("air_temperature_k", season_.has_air_temperature_k()),
          absl::StrCat("= ", weather_.air_temperature_k(), " is ", std::abs(warmer_k), " K ",
                       warmer_k > 0 ? "above" : "below", " the surface of the profile \"",
                       weather_.profile(), "\" (", profile, " K) that is bent to it"));
  }

  static double profile_surface_k(const schema::Weather& unbent);

  void check_profile_name(const std::string& path) {
    if (!has_position(sweep_)) return;
    const double latitude_deg = sweep_.place().latitude_deg();
    const std::string& name = weather_.profile();
    int month = std::atoi(season_.date().substr(5, 2).c_str());
    if (latitude_deg < 0) month = (month + 5) % 12 + 1;  // six months later
    const bool of_summer = name.ends_with("summer"), of_winter = name.ends_with("winter");
    const bool in_winter = month <= 2 || month >= 11, in_summer = month >= 5 && month <= 8;
    const std::string what =
        absl::StrCat("= \"", name, "\" and ", of_season("date"), " = ", season_.date(),
                     " at place.latitude_deg = ", latitude_deg);
    if ((of_summer && in_winter) || (of_winter && in_summer)) {
      contradiction(path, absl::StrCat(what, " contradict each other: the date is in ",
                                       in_winter ? "winter" : "summer"));
    } else if ((of_summer && (month == 3 || month == 10)) ||
               (of_winter && (month == 4 || month == 9))) {
      odd(path, absl::StrCat(what, ": the date is near the other half of the year"));
    }
    const double poleward_deg = std::abs(latitude_deg);
    if ((name == "tropical" && poleward_deg > 45) ||
        (name.starts_with("midlatitude") && (poleward_deg < 15 || poleward_deg > 70)) ||
        (name.starts_with("subarctic") && poleward_deg < 40)) {
      odd(path, absl::StrCat("= \"", name, "\" is far from place.latitude_deg = ", latitude_deg));
    }
  }

  // Sea level has had 870 to 1085 hPa; 15 % and 8 % about the standard atmosphere's.
  void check_pressure() {
    if (!has_position(sweep_)) return;
    const double height_m = sweep_.place().height_m();
    const double standard_pa = standard_pressure_pa(height_m);
    const double ratio = weather_.pressure_pa() / standard_pa;
    const Name path = weather_.surface_stated()
                          ? of_surface("pressure_pa", season_.has_pressure_pa())
                          : Name{"place.height_m", "place.height_m"};
    const std::string what =
        weather_.surface_stated()
            ? absl::StrCat("= ", weather_.pressure_pa(), " and place.height_m = ", height_m)
            : absl::StrCat("= ", height_m, " and the profile's ", weather_.pressure_pa(),
                           " Pa at the surface");
    const std::string expected =
        absl::StrCat("the standard atmosphere has ", std::round(standard_pa), " Pa there");
    if (!(ratio > 0.85 && ratio < 1.08)) {
      contradiction(
          path,
          absl::StrCat(what, " contradict each other: ", expected,
                       weather_.surface_stated() ? "" : ", expected the season's surface weather"));
    } else if (!(ratio > 0.95 && ratio < 1.05)) {
      odd(path, absl::StrCat(what, " fit badly: ", expected));
    }
  }

  void check_humidity() {
    const double percent = weather_.relative_humidity_percent();
    if (weather_.surface_stated() && percent > 0 && percent <= 1)
      odd(of_surface("relative_humidity_percent", season_.has_relative_humidity_percent()),
          absl::StrCat("= ", percent, " is drier than any desert: is it a fraction? ",
                       100 * percent, " % are relative_humidity_percent = ", 100 * percent));
  }

  void check_aerosol() {
    const bool fog = weather_.aerosol() == "advection_fog" || weather_.aerosol() == "radiation_fog";
    const std::string visibility =
        season_.has_visibility_m() ? of_season("visibility_m") : "air.visibility_m";
    if (fog && weather_.relative_humidity_percent() < 95)
      odd("air.aerosol",
          absl::StrCat("= \"", weather_.aerosol(), "\", but the air at the surface has ",
                       weather_.relative_humidity_percent(), " % relative humidity in season \"",
                       season_.name(), "\": fog needs 95 % or more"));
    if (fog && weather_.visibility_m() > 1000)
      odd(visibility, absl::StrCat("= ", weather_.visibility_m(), " in air.aerosol = \"",
                                   weather_.aerosol(), "\": fog is a visibility below 1 km"));
    if (!fog && weather_.visibility_m() > 0 && weather_.visibility_m() < 1000)
      odd(visibility, absl::StrCat("= ", weather_.visibility_m(), " is fog, but air.aerosol = \"",
                                   weather_.aerosol(), "\""));
  }

  // Against the air above: `limit` is a contradiction, `odd_limit` odd.
  void check_step(const std::string& path, double surface_k, double odd_limit_k, double limit_k) {
    const double step_k = surface_k - weather_.air_temperature_k();
    const std::string what = absl::StrCat("= ", surface_k, " and ", air_text(), " in season \"",
                                          season_.name(), "\" differ by ", std::abs(step_k), " K");
    if (std::abs(step_k) > limit_k) {
      contradiction(path, absl::StrCat(what, ", expected at most ", limit_k, " K"));
    } else if (std::abs(step_k) > odd_limit_k) {
      odd(path, what);
    }
  }

  void check_sea() {
    constexpr double kMostSlopeWindMS = 20;
    if (condition_.surroundings().sea_model() == "cox_munk" &&
        weather_.wind_speed_m_s() > kMostSlopeWindMS)
      odd(of_surface("wind_speed_m_s", season_.has_wind_speed_m_s()),
          absl::StrCat("= ", absl::SixDigits(weather_.wind_speed_m_s()),
                       ": the slopes of sea waves are known up to ", kMostSlopeWindMS,
                       " m/s and held there; the model error of the sea is larger"));
    const double sea_k = condition_.surroundings().sea_temperature_k();
    const std::string path =
        of_surroundings("sea_temperature_k", season_.surroundings().has_sea_temperature_k());
    if (sea_k < 271.3) {
      contradiction(path, absl::StrCat("= ", sea_k,
                                       " is ice, expected 271.3 K, where sea water "
                                       "freezes, or more",
                                       perhaps_celsius(sea_k)));
    } else if (sea_k > 308) {
      contradiction(path, absl::StrCat("= ", sea_k,
                                       " is warmer than any sea, expected at most "
                                       "308 K"));
    } else {
      check_step(path, sea_k, 15, 30);
    }
    if (sweep_.has_place() && sweep_.place().height_m() > 3000)
      odd("place.height_m",
          absl::StrCat("= ", sweep_.place().height_m(), ", but surroundings.kind = \"sea\""));
  }

  // Dry soil in the sun is 40 K above the air at 1.5 m, snow in a calm night 15 K below.
  void check_ground() {
    const double ground_k = condition_.surroundings().ground_temperature_k();
    const std::string path =
        of_surroundings("ground_temperature_k", season_.surroundings().has_ground_temperature_k());
    if (!(ground_k >= 180 && ground_k <= 370)) {
      contradiction(
          path, absl::StrCat("= ", ground_k, ", expected 180 to 370 K", perhaps_celsius(ground_k)));
    } else {
      check_step(path, ground_k, 30, 60);
    }
  }

  // A surface that cools by radiation ends at the sky's temperature. The broadband temperature of a
  // clear sky is 0.0552 T^1.5 of the air's [swinbank1963], 20 K less where the air is driest.
  void check_part(int p) {
    const schema::Part& part = sweep_.part(p);
    const auto& by_field = condition_.temperature_field().part();
    if (std::find(by_field.begin(), by_field.end(), p) != by_field.end()) return;
    const double part_k = condition_.part_temperature_k(p);
    const bool in_season = season_.part_temperature_k().contains(part.name());
    const std::string path = in_season ? of_season("part_temperature_k." + part.name())
                                       : absl::StrCat("part[", p, "].temperature_k");
    const double coldest_sky_k = swinbank_sky_k(weather_.air_temperature_k()) - 20;
    if (part_k < coldest_sky_k) {
      odd(path, absl::StrCat("= ", part_k, " is colder than any sky above ", air_text(),
                             " in season \"", season_.name(), "\" (", std::round(coldest_sky_k),
                             " K)", perhaps_celsius(part_k)));
    } else if (part_k < weather_.air_temperature_k() - 20) {
      odd(path, absl::StrCat("= ", part_k, " is more than 20 K colder than ", air_text(),
                             " in season \"", season_.name(), "\""));
    }
  }

  schema::ResolvedSweep& resolved_;
  const schema::Sweep& sweep_;
  const schema::Season& season_;
  schema::Condition& condition_;
  const schema::Weather& weather_;
  Findings& findings_;
  int index_;
  bool alone_;
};

double SeasonGate::profile_surface_k(const schema::Weather& unbent) {
  const auto profile = profile_from_message(unbent);
  return profile.ok() ? profile->level.front().temperature_k : unbent.air_temperature_k();
}

}  // namespace

void check_units(schema::ResolvedSweep& resolved, Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  const int times = sweep.time_size();
  const double error = sweep.accuracy().relative_error();
  for (int s = 0; s < sweep.season_size(); ++s) {
    if (error > 0.3)
      warn_season(resolved, s, "accuracy.relative_error",
                  absl::StrCat("accuracy.relative_error = ", error, " is ", 100 * error,
                               " %: is it in percent? ", error, " % are ", error / 100),
                  findings);
    for (int b = 0; b < sweep.band_size(); ++b) {
      const schema::Band& band = sweep.band(b);
      const double width_um = band.lambda_max_um() - band.lambda_min_um(),
                   step_um = width_um / std::round(width_um / band.step_um());
      if (std::abs(step_um / band.step_um() - 1) > 0.01)
        warn_season(resolved, s, absl::StrCat("band[", b, "].step_um"),
                    absl::StrCat("band[", b, "].step_um = ", band.step_um(), " does not divide ",
                                 width_um, " um: ", absl::SixDigits(step_um), " is taken"),
                    findings);
    }
    if (has_atmosphere(resolved)) continue;
    // Idealised worlds may be at 0 K.
    const schema::Season& season = sweep.season(s);
    for (int p = 0; p < sweep.part_size(); ++p) {
      const double k = resolved.condition(s * times).part_temperature_k(p);
      if (!(k > 0 && k < 100)) continue;
      const std::string& part = sweep.part(p).name();
      const std::string path = season.part_temperature_k().contains(part)
                                   ? absl::StrCat("season[", s, "].part_temperature_k.", part)
                                   : absl::StrCat("part[", p, "].temperature_k");
      warn_season(
          resolved, s, path,
          absl::StrCat(path, " = ", k, " is colder than anything outdoors", perhaps_celsius(k)),
          findings);
    }
  }
}

void check_surfaces(schema::ResolvedSweep& resolved, Findings& findings) {
  if (!has_atmosphere(resolved)) return;
  for (int s = 0; s < resolved.sweep().season_size(); ++s) {
    const schema::Season& season = resolved.sweep().season(s);
    const bool goes_on = season.has_weather_file() || season.has_day();
    for (int t = 0; t < (goes_on ? resolved.sweep().time_size() : 1); ++t)
      SeasonGate(resolved, s, t, goes_on, findings).check();
  }
  if (findings.empty()) check_lines(resolved, findings);
}

}  // namespace irsig
