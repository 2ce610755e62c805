#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/atmosphere/air_profile.h"
#include "jobs/resolve.h"
#include "jobs/resolve_cloud.h"
#include "jobs/resolve_plume.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {
namespace {

constexpr double kDefaultCo2Ppmv = 425;  // AtmosphereSpec's: the mean of 2024
constexpr double kDefaultAirMass = 3;    // AerosolSpec's

SectionCheck::Names profile_names() {
  SectionCheck::Names names;
  for (const AfglProfile p : {AfglProfile::kTropical, AfglProfile::kMidlatitudeSummer,
                              AfglProfile::kMidlatitudeWinter, AfglProfile::kSubarcticSummer,
                              AfglProfile::kSubarcticWinter, AfglProfile::kUsStandard1976}) {
    names.push_back(name_of(p).data());  // of string literals
  }
  return names;
}

bool navy(const schema::Air& air) { return air.aerosol() == "navy_maritime"; }

void check_homogeneous(const SectionCheck& check) {
  check.only({"model", "absorption_m2_kg", "pressure_pa", "gas_constant_j_kg_k", "path_emission"},
             "to model \"homogeneous\"");
  check.require({"absorption_m2_kg"}, "expected the mass absorption coefficient in m2/kg");
  check.require({"pressure_pa"}, "expected the air pressure in Pa (101325 at sea level)");
  check.require({"gas_constant_j_kg_k"},
                "expected the specific gas constant in J/(kg K) (287 for dry air)");
  check.require({"path_emission"}, "expected true or false: whether the air itself radiates");
}

void check_atmosphere(const schema::Sweep& sweep, const SectionCheck& check) {
  const schema::Air& air = sweep.air();
  check.only({"model", "profile", "profile_file", "aerosol", "visibility_m", "air_mass", "co2_ppmv",
              "refraction"},
             "to model \"atmosphere\"");
  (void)check.at_most_one({"profile", "profile_file"});
  (void)check.one_of("profile", profile_names());
  const auto aerosols = aerosol_names();
  check.require({"aerosol"},
                "expected the particles in the air: \"maritime\", \"rural\", \"none\" ...");
  const bool known = check.one_of("aerosol", {aerosols.begin(), aerosols.end()});
  if (!known) return;
  if (air.has_air_mass() && !navy(air))
    check.error("air_mass", absl::StrCat("does not apply to aerosol \"", air.aerosol(),
                                         "\", expected only with \"navy_maritime\""));
  if (air.aerosol() == "none") {
    if (air.has_visibility_m()) check.error("visibility_m", "does not apply to aerosol \"none\"");
    return;
  }
  const bool in_every_season =
      std::all_of(sweep.season().begin(), sweep.season().end(),
                  [](const schema::Season& s) { return s.has_visibility_m(); });
  if (!in_every_season && !navy(air))
    check.require({"visibility_m"},
                  "expected the meteorological range in metres, here or in every season");
}

// Returns the dew point of air at `temperature_k`. Bisection is fast enough: the result is for a
// message.
double dew_point_at(double temperature_k, double humidity_percent) {
  const double vapour_pa = humidity_percent / 100 * saturation_pressure_pa(temperature_k);
  double low_k = 150, high_k = 400;
  for (int i = 0; i < 60; ++i) {
    const double middle_k = (low_k + high_k) / 2;
    (saturation_pressure_pa(middle_k) < vapour_pa ? low_k : high_k) = middle_k;
  }
  return low_k;
}

// A day that is stated: its air, and what else a day needs.
void check_day(const schema::Season& season, const std::string& path, const SectionCheck& of_season,
               Findings& findings) {
  const schema::Day& day = season.day();
  const SectionCheck check(day, path, findings);
  check.require({"air_temperature_min_k", "air_temperature_max_k"},
                "expected the day's lowest and highest temperature of the air");
  check.require({"dew_point_k"}, "expected the dew point of the day's air");
  of_season.require({"pressure_pa", "wind_speed_m_s"}, "expected it beside the day");
  if (day.air_temperature_max_k() < day.air_temperature_min_k() && day.has_air_temperature_max_k())
    check.error("air_temperature_max_k",
                absl::StrCat("= ", day.air_temperature_max_k(),
                             " is below air_temperature_min_k = ", day.air_temperature_min_k()));
  if (day.has_air_temperature_min_k() && day.dew_point_k() > day.air_temperature_min_k())
    check.error("dew_point_k",
                absl::StrCat("= ", day.dew_point_k(), " is above air_temperature_min_k = ",
                             day.air_temperature_min_k(), ": water would leave the air at night"));
}

void check_surface_weather(const schema::Season& season, bool heat, const std::string& path,
                           const SectionCheck& check, Findings& findings) {
  const SectionCheck::Names names = {"air_temperature_k", "relative_humidity_percent",
                                     "pressure_pa"};
  const auto stated =
      std::count_if(names.begin(), names.end(), [&](const char* name) { return check.has(name); });
  (void)check.at_most_one({"weather_file", "day"});
  if (season.has_day()) check_day(season, path + ".day", check, findings);
  const bool goes_on = season.has_weather_file() || season.has_day();
  if (heat && !goes_on) {
    check.require(
        {"air_temperature_k", "relative_humidity_percent", "pressure_pa", "wind_speed_m_s"},
        "expected it, a weather_file or a day: temperatures are computed from the weather");
    if (season.has_relative_humidity_percent() && season.relative_humidity_percent() == 0)
      check.error(
          "relative_humidity_percent",
          "= 0, expected more: temperatures are computed, and there is no such air outdoors");
  } else if (stated > 0 && !goes_on)
    check.require(names,
                  "expected the weather at the surface in all of air_temperature_k, "
                  "relative_humidity_percent and pressure_pa, or in none of them");
  // A limit of bend_to_surface().
  check.within("air_temperature_k", 180, 340);
  if (season.relative_humidity_percent() > 100 && season.has_air_temperature_k()) {
    check.error("relative_humidity_percent",
                absl::StrCat("= ", season.relative_humidity_percent(), " puts the dew point at ",
                             absl::SixDigits(dew_point_at(season.air_temperature_k(),
                                                          season.relative_humidity_percent())),
                             " K, above air_temperature_k = ", season.air_temperature_k(),
                             ", expected a number from 0 to 100"));
  } else {
    check.within("relative_humidity_percent", 0, 100);
  }
}

// needed: for computed temperatures, or by a day.
void check_wind(const schema::Air& air, const schema::Surroundings& surroundings, bool needed,
                const SectionCheck& check) {
  const bool rough = surroundings.kind() == "sea" && surroundings.sea_model() == "cox_munk";
  const std::string why =
      rough ? "sea_model = \"cox_munk\"" : absl::StrCat("air.aerosol = \"", air.aerosol(), "\"");
  if (check.has("weather_file")) {
    // Its own.
  } else if (rough || navy(air)) {
    check.require(
        {"wind_speed_m_s"},
        absl::StrCat("expected the wind 10 m above the surface: ", why, " depends on it"));
  } else if (check.has("wind_speed_m_s") && !needed &&
             (surroundings.kind() == "sea" || surroundings.kind() == "ground" ||
              surroundings.kind() == "none")) {  // others are wrong themselves
    check.error("wind_speed_m_s",
                "does not apply, expected only with sea_model \"cox_munk\" or aerosol "
                "\"navy_maritime\"");
  }
  if (!navy(air) && check.has("wind_speed_24h_m_s"))
    check.error("wind_speed_24h_m_s",
                "does not apply, expected only with air.aerosol = \"navy_maritime\"");
}

// Requires the wind of a season whose weather bends a funnel's plume.
void require_wind(const SectionCheck& check, const Findings& findings) {
  if (!findings.any_at(check.path("wind_speed_m_s")))
    check.require({"wind_speed_m_s"}, "expected the wind: it bends the funnel's plume (0: calm)");
  check.require({"wind_from_deg"},
                "expected where the wind comes from, clockwise from north: it bends the funnel's "
                "plume");
}

// Returns true if the season's profile follows from place and date.
bool by_place(const schema::Sweep& sweep, const schema::Season& season) {
  if (season.has_profile()) return false;
  return season.has_profile_file() || !sweep.air().has_profile();
}

void check_weather_of_season(const schema::Sweep& sweep, const schema::Season& season,
                             const schema::Surroundings& surroundings, int season_index,
                             const std::string& path, Findings& findings) {
  const schema::Air& air = sweep.air();
  const SectionCheck check(season, path, findings);
  if (season.has_sun_irradiance_w_m2())
    check.error("sun_irradiance_w_m2",
                "does not apply to air.model \"atmosphere\", which computes the sun's irradiance");
  check_surface_weather(season, sweep.has_heat(), path, check, findings);
  check_cloud_of_season(season, season_index, findings);
  check_wind(air, surroundings, sweep.has_heat() || season.has_day() || has_funnel_plume(sweep),
             check);
  if (has_funnel_plume(sweep)) {
    if (!season.has_weather_file()) require_wind(check, findings);
  } else if (check.has("wind_from_deg") && !sweep.has_heat()) {
    check.error("wind_from_deg", "does not apply without [heat] or a funnel's [plume]");
  }
  if (air.aerosol() == "none" && season.has_visibility_m())
    check.error("visibility_m", "does not apply to air.aerosol \"none\"");
  (void)check.at_most_one({"profile", "profile_file"});
  (void)check.one_of("profile", profile_names());
  if (by_place(sweep, season) && !sweep.place().has_latitude_deg())
    findings.add(sweep.has_place() ? "place" : "air",
                 "place.latitude_deg is missing, expected it or air.profile: the atmosphere's "
                 "profile follows from latitude and date");
}

void resolve_profile(const SweepFile& file, int season_index, int month, schema::Weather& weather,
                     Findings& findings) {
  const schema::Sweep& sweep = file.sweep;
  const schema::Season& season = sweep.season(season_index);
  weather.set_profile(season.has_profile()      ? season.profile()
                      : by_place(sweep, season) ? std::string(name_of(default_afgl_profile(
                                                      sweep.place().latitude_deg(), month)))
                                                : sweep.air().profile());
  const bool own_file = season.has_profile_file();
  if (!own_file && (season.has_profile() || !sweep.air().has_profile_file())) return;
  const std::string path =
      own_file ? absl::StrCat("season[", season_index, "].profile_file") : "air.profile_file";
  const auto text = file.content.find(path);
  if (text == file.content.end()) {
    findings.add(path, path + " was not read");
    return;
  }
  weather.set_profile_file_name(own_file ? season.profile_file() : sweep.air().profile_file());
  weather.set_profile_csv(text->second);
}

}  // namespace

void check_air(const schema::Sweep& sweep, Findings& findings) {
  constexpr const char* kModels = "expected model = \"vacuum\", \"homogeneous\" or \"atmosphere\"";
  if (!sweep.has_air()) {
    findings.add("air", absl::StrCat("[air] is missing, ", kModels));
    return;
  }
  const SectionCheck check(sweep.air(), "air", findings);
  check.require({"model"}, "expected \"vacuum\", \"homogeneous\" or \"atmosphere\"");
  if (!check.one_of("model", {"vacuum", "homogeneous", "atmosphere"})) return;
  if (sweep.air().model() == "vacuum") check.only({"model"}, "to model \"vacuum\"");
  if (sweep.air().model() == "homogeneous") check_homogeneous(check);
  if (sweep.air().model() == "atmosphere") check_atmosphere(sweep, check);
}

void check_season_air(const schema::Sweep& sweep, int season_index,
                      const schema::Surroundings& surroundings, Findings& findings) {
  const schema::Season& season = sweep.season(season_index);
  const std::string path = absl::StrCat("season[", season_index, "]");
  const SectionCheck check(season, path, findings);
  const std::string& model = sweep.air().model();
  if (model == "atmosphere") {
    check_weather_of_season(sweep, season, surroundings, season_index, path, findings);
    return;
  }
  SectionCheck::Names of_any_air = {"name",
                                    "date",
                                    "time",
                                    "part_temperature_k",
                                    "temperature_field",
                                    "surroundings",
                                    "sun_irradiance_w_m2",
                                    "air_temperature_k"};
  if (check.has("land_temperature_k")) of_any_air.push_back("land_temperature_k");  // check_land()
  if (model == "homogeneous" && has_funnel_plume(sweep)) {
    of_any_air.insert(of_any_air.end(), {"wind_speed_m_s", "wind_from_deg"});
    require_wind(check, findings);
  }
  if (model == "vacuum" || model == "homogeneous") {
    const std::string why = absl::StrCat("to air.model \"", model, "\"");
    for (const char* key : kCloudKeys) {
      if (!check.has(key)) continue;
      check.error(key, absl::StrCat("does not apply ", why,
                                    ", which has no clouds: expected air.model = \"atmosphere\""));
      of_any_air.push_back(key);  // reported
    }
    check.only(of_any_air, why);
  }
  if (model == "homogeneous")
    check.require({"air_temperature_k"}, "expected the air's temperature: the air is homogeneous");
  if (season.has_air_temperature_k() && season.air_temperature_k() == 0 && model == "homogeneous")
    check.error("air_temperature_k",
                "= 0, expected a temperature above 0: the air's density depends on it");
}

schema::Weather resolve_weather(const SweepFile& file, int season_index,
                                const schema::Season& season, int month, Findings& findings) {
  const schema::Air& air = file.sweep.air();
  schema::Weather weather;
  resolve_profile(file, season_index, month, weather, findings);
  weather.set_aerosol(air.aerosol());
  weather.set_visibility_m(season.has_visibility_m() ? season.visibility_m() : air.visibility_m());
  if (navy(air)) {
    constexpr double kMostNavyWindMS = 20;
    if (season.wind_speed_m_s() > kMostNavyWindMS) {
      const std::string path = absl::StrCat("season[", season_index, "].wind_speed_m_s");
      if (!findings.any_at(path))
        findings.add(path, absl::StrCat(path, " = ", absl::SixDigits(season.wind_speed_m_s()),
                                        ": air.aerosol = \"navy_maritime\" holds from 0 to ",
                                        kMostNavyWindMS, " m/s, expected another hour or aerosol"));
    }
    weather.set_air_mass(air.has_air_mass() ? air.air_mass() : kDefaultAirMass);
    weather.set_wind_speed_24h_m_s(season.has_wind_speed_24h_m_s() ? season.wind_speed_24h_m_s()
                                                                   : season.wind_speed_m_s());
  }
  weather.set_wind_speed_m_s(season.wind_speed_m_s());
  weather.set_above_surface_m(above_surface_m(file.sweep, season));
  weather.set_place_height_m(
      std::max(0.0, file.sweep.place().height_m() - file.sweep.land().geoid_m()));
  // LOWTRAN's rule: the season of what lies above 2 km is the profile's.
  weather.set_summer_troposphere(weather.profile().find("winter") == std::string::npos);
  weather.set_co2_ppmv(air.has_co2_ppmv() ? air.co2_ppmv() : kDefaultCo2Ppmv);
  weather.set_refraction(!air.has_refraction() || air.refraction());
  weather.set_surface_stated(season.has_air_temperature_k());
  weather.set_air_temperature_k(season.air_temperature_k());
  weather.set_relative_humidity_percent(season.relative_humidity_percent());
  weather.set_pressure_pa(season.pressure_pa());
  if (season.has_modtran_file()) {
    const std::string path = absl::StrCat("season[", season_index, "].modtran_file");
    const auto text = file.content.find(path);
    if (text == file.content.end()) {
      findings.add(path, path + " was not read");
    } else {
      weather.set_modtran_file_name(season.modtran_file());
      weather.set_modtran_text(text->second);
    }
  }
  if (!findings.empty() || weather.surface_stated()) return weather;
  // The profile's surface values are written out, so that later readers of the sweep need no
  // profile.
  const auto profile = profile_from_message(weather);
  if (!profile.ok()) {
    const std::string path = absl::StrCat("season[", season_index, "]");
    findings.add(path, absl::StrCat(path, " has no profile: ", profile.status().message()));
    return weather;
  }
  const AirLevel& surface = profile->level.front();
  weather.set_air_temperature_k(surface.temperature_k);
  weather.set_relative_humidity_percent(relative_humidity_percent(surface));
  weather.set_pressure_pa(surface.pressure_pa);
  return weather;
}

void write_air_defaults(schema::Air& air) {
  if (air.model() != "atmosphere") return;
  if (!air.has_co2_ppmv()) air.set_co2_ppmv(kDefaultCo2Ppmv);
  if (!air.has_refraction()) air.set_refraction(true);
  if (navy(air) && !air.has_air_mass()) air.set_air_mass(kDefaultAirMass);
}

}  // namespace irsig
