#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "core/atmosphere/air_profile.h"
#include "core/atmosphere/imported/imported_path.h"
#include "core/atmosphere/light_path.h"
#include "jobs/consistency/check_weather.h"
#include "jobs/text/sweep_places.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {
namespace {

// Line of sight above a spherical sea or ground, as in Environment::line: the sensor's height, and
// its distance from the point that stands for the target. above_m is the height of the target's
// reference point, from which viewpoints count.
struct Sight {
  double sensor_m, range_m;
};
Sight sight_of(double target_m, double above_m, const schema::Viewpoint& view) {
  const double elevation = view.aspect_elevation_deg() * M_PI / 180;
  const double r = view.range_m(), up_m = r * std::sin(elevation) + above_m,
               along_m = r * std::cos(elevation);
  return {(up_m * up_m + along_m * along_m + 2 * kEarthRadiusM * up_m) /
              (std::hypot(kEarthRadiusM + up_m, along_m) + kEarthRadiusM),
          std::hypot(up_m - target_m, along_m)};
}

std::string viewpoint_text(int index, const schema::Viewpoint& view) {
  return absl::StrCat("viewpoint ", index, " (azimuth ", view.aspect_azimuth_deg(), ", elevation ",
                      view.aspect_elevation_deg(), ", range ", view.range_m(), " m)");
}

// A file's levels or the weather at the surface may fit by themselves and not below the rest of the
// profile, whose pressures are scaled to join.
void check_joined_profile(const schema::Sweep& sweep, int s, const AirProfile& profile,
                          Findings& findings) {
  const absl::Status status = check_profile(profile);
  if (status.ok()) return;
  const schema::Season& season = sweep.season(s);
  const std::string own = absl::StrCat("season[", s, "].");
  const std::string path = season.has_profile_file() ? own + "profile_file"
                           : !season.has_profile() && sweep.air().has_profile_file()
                               ? "air.profile_file"
                           : season.has_pressure_pa() ? own + "pressure_pa"
                                                      : own + "date";
  findings.add(path, absl::StrCat(path, " does not fit the air above: ", status.message()));
}

// Lines that fall away from the target: the others cannot meet the surface.
void check_hidden(const schema::ResolvedSweep& resolved, int s, const WeatherSpec& weather,
                  Findings& findings) {
  const double above_m = weather.above_surface_m;
  const double target_m = air_point_height_m(resolved, above_m);
  for (int v = 0; v < resolved.viewpoint_size(); ++v) {
    const schema::Viewpoint& view = resolved.viewpoint(v);
    if (view.aspect_elevation_deg() >= 0) continue;
    const Sight sight = sight_of(target_m, above_m, view);
    const auto path = look_between(weather.air.profile, sight.sensor_m, target_m, sight.range_m,
                                   weather.refraction);
    // The part of the target that the Earth hides is found once its mesh is known.
    if (path.ok() || absl::IsOutOfRange(path.status())) continue;
    findings.add(viewpoint_path(resolved.sweep().viewpoints(), static_cast<std::size_t>(v),
                                static_cast<std::size_t>(resolved.viewpoint_size())),
                 absl::StrCat(viewpoint_text(v, view), " does not see the target in season \"",
                              resolved.sweep().season(s).name(), "\": ", path.status().message()));
  }
}

// Every band of the air that a band of the sweep reaches into must be in the file.
void check_wavelengths(const schema::Sweep& sweep, const ImportedPath& imported,
                       const std::string& path, Findings& findings) {
  for (const schema::Band& band : sweep.band()) {
    for (std::size_t b = 0; b < imported.transmittance.size(); ++b) {
      const double half_cm1 = kAirBandWidthCm1 / 2;
      const double least_um = 1e4 / (air_band_centre_cm1(b) + half_cm1);
      const double most_um = 1e4 / (air_band_centre_cm1(b) - half_cm1);
      if (least_um >= band.lambda_max_um() || most_um <= band.lambda_min_um()) continue;
      if (!std::isnan(imported.transmittance[b])) continue;
      findings.add(path,
                   absl::StrCat(path, ": the path that begins in line ", imported.line,
                                " has no transmittance from ", absl::SixDigits(least_um), " to ",
                                absl::SixDigits(most_um), " um, in band \"", band.name(), "\""));
      return;
    }
  }
}

void check_import(schema::ResolvedSweep& resolved, int s, const WeatherSpec& weather,
                  Findings& findings) {
  const ImportedPaths& paths = *weather.imported;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const schema::Sweep& sweep = resolved.sweep();
  const std::string path = absl::StrCat("season[", s, "].modtran_file");
  const int times = sweep.time_size();
  for (int t = 0; t < times; ++t) {
    const schema::Condition& condition = resolved.condition(s * times + t);
    const schema::Surroundings& around = condition.surroundings();
    const SunThere sun = sun_there(sweep.place(), condition);
    const bool placed = has_position(sweep);
    const absl::Status agrees = check_conditions(
        paths, {.sun_zenith_deg = placed ? 90 - sun.elevation_deg : kUnknown,
                .latitude_deg = placed ? sweep.place().latitude_deg() : kUnknown,
                .longitude_deg = placed ? sweep.place().longitude_deg() : kUnknown,
                .ground_temperature_k = around.kind() == "sea" ? around.sea_temperature_k()
                                                               : around.ground_temperature_k(),
                .day_of_year = sun.day_of_year});
    if (!agrees.ok())
      findings.add(path, absl::StrCat(path, " was not made for ", condition.time_utc(), ": ",
                                      absl::StrReplaceAll(agrees.message(), {{"\n", "; "}})));
  }
  const double above_m = weather.above_surface_m;
  const double target_m = air_point_height_m(resolved, above_m);
  double off_m = 0;  // of ends of lines that a level path stands for
  for (int v = 0; v < resolved.viewpoint_size(); ++v) {
    const schema::Viewpoint& view = resolved.viewpoint(v);
    const Sight sight = sight_of(target_m, above_m, view);
    const auto found = find_path(paths, sight.sensor_m, target_m, sight.range_m);
    if (found.ok()) {
      check_wavelengths(sweep, **found, path, findings);
      for (const auto& [line_m, path_m] : {std::pair{sight.sensor_m, (*found)->observer_height_m},
                                           std::pair{target_m, (*found)->target_height_m}})
        off_m = std::max(off_m, std::abs(line_m - path_m));
      continue;
    }
    findings.add(path, absl::StrCat(path, " does not cover ", viewpoint_text(v, view), ": ",
                                    absl::StrReplaceAll(found.status().message(), {{"\n", "; "}})));
    return;  // the others are most likely missing too
  }
  // Heights that find_path accepts as equal cause no warning.
  if (off_m > std::max(1.0, 0.02 * target_m))
    warn_season(resolved, s, path,
                absl::StrFormat("%s: a level path stands for lines of sight whose ends are up to "
                                "%.3g m away from its height",
                                path, off_m),
                findings);
}

}  // namespace

void check_lines(schema::ResolvedSweep& resolved, Findings& findings) {
  const int times = resolved.sweep().time_size();
  for (int s = 0; s < resolved.sweep().season_size(); ++s) {
    const schema::Condition& condition = resolved.condition(s * times);
    const auto weather = weather_from_message(condition.weather(), condition.surroundings());
    if (!weather.ok()) {
      const std::string path = absl::StrCat("season[", s, "]");
      findings.add(path, absl::StrCat(path, ": ", weather.status().message()));
      continue;
    }
    check_joined_profile(resolved.sweep(), s, weather->air.profile, findings);
    check_hidden(resolved, s, *weather, findings);
    if (weather->imported != nullptr) check_import(resolved, s, *weather, findings);
  }
}

}  // namespace irsig
