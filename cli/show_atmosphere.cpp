#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/air_options.h"
#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/atmosphere/imported/imported_path.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/environment/weather_air.h"
#include "core/geo/sun.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"
#include "view/base/table.h"
#include "view/plot/plot_curves.h"

// irsig show atmosphere | sky | sun: what core/atmosphere and a cloud's light in core/environment
// answer, as CSV or drawn.
namespace irsig {
namespace {

// Which of the air's bands are shown.
struct BandRange {
  double lambda_min_um = 1e4 / kAirLastCm1, lambda_max_um = 1e4 / kAirFirstCm1;

  void add_to(CLI::App& command) {
    command.add_option("--lambda-min-um", lambda_min_um,
                       "Shortest wavelength (default: all, from 2.94 um)");
    command.add_option("--lambda-max-um", lambda_max_um,
                       "Longest wavelength (default: all, to 15.4 um)");
  }
  [[nodiscard]] absl::Status check() const {
    if (!(lambda_min_um < lambda_max_um)) {
      return absl::InvalidArgumentError(absl::StrCat(
          "--lambda-min-um ", lambda_min_um, " is not below --lambda-max-um ", lambda_max_um));
    }
    if (lambda_min_um > 1e4 / kAirFirstCm1 || lambda_max_um < 1e4 / kAirLastCm1) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%g to %g um: the air's table covers 2.94 to 15.4 um", lambda_min_um, lambda_max_um));
    }
    return absl::OkStatus();
  }
  [[nodiscard]] bool has(std::size_t band) const {
    const double lambda_um = air_band_lambda_um(band);
    return lambda_um >= lambda_min_um && lambda_um <= lambda_max_um;
  }
};

// The sun where the air is, if there is to be any.
struct SunOptions {
  std::optional<double> zenith_deg, azimuth_deg;

  std::string azimuth_name;  // of its option

  void add_to(CLI::App& command, const char* name, const char* azimuth_meaning) {
    azimuth_name = name;
    command.add_option("--sun-zenith-deg", zenith_deg, "With sunlight: 0 to 180, airless");
    command.add_option(azimuth_name, azimuth_deg, azimuth_meaning);
  }
  [[nodiscard]] absl::StatusOr<std::optional<SunPlace>> place(double azimuth_of_path_deg) const {
    if (!zenith_deg && !azimuth_deg) return std::optional<SunPlace>();
    if (!zenith_deg || !azimuth_deg) {
      return absl::InvalidArgumentError(
          absl::StrCat("--sun-zenith-deg and ", azimuth_name, " belong together"));
    }
    if (!(*zenith_deg >= 0 && *zenith_deg <= 180)) {
      return absl::InvalidArgumentError(
          absl::StrCat("--sun-zenith-deg ", *zenith_deg, ": expected 0 to 180"));
    }
    if (!(*azimuth_deg >= -360 && *azimuth_deg <= 360)) {
      return absl::InvalidArgumentError(
          absl::StrCat(azimuth_name, " ", *azimuth_deg, ": expected -360 to 360"));
    }
    return std::optional(SunPlace{*zenith_deg, *azimuth_deg - azimuth_of_path_deg});
  }
};

absl::Status check_number(const char* option, double value, double min, double max) {
  if (value >= min && value <= max) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s %g: expected %g to %g", option, value, min, max));
}

const std::vector<std::string> kAirFormats = {"csv", "json", "text", "svg"};

absl::Status write_table(const std::vector<std::string>& heads,
                         const std::vector<std::vector<Cell>>& rows, std::string_view format,
                         std::ostream& out) {
  ASSIGN_OR_RETURN(auto writer,
                   make_table_writer(format, std::vector<Column>(heads.begin(), heads.end()), out));
  for (const std::vector<Cell>& row : rows) writer->row(row);
  return writer->finish();
}

void warn_of_scattering(const PathRadiance& path) {
  if (!path.beyond_single_scattering()) return;
  std::fprintf(
      stderr,
      "irsig: warning: scattering optical depth %.2g: more than one scattering counts, and "
      "the model error holds all that is scattered\n",
      path.scattering_optical_depth);
}

// ---- drawing

Curve curve_of(const std::string& name, const AirSpectrum& value, double lambda_min_um,
               double lambda_max_um) {
  Curve out{name, {}, {}};
  for (std::size_t b = kAirBandCount; b-- > 0;) {  // increasing wavelength
    const double lambda_um = air_band_lambda_um(b);
    if (lambda_um < lambda_min_um || lambda_um > lambda_max_um) continue;
    out.x.push_back(lambda_um);
    out.y.push_back(value[b]);
  }
  return out;
}

struct DrawnSpectrum {
  std::string name;
  AirSpectrum transmittance, radiance_w_m2_sr_um;  // empty: not known
};

// Transmittance above, radiance below; the two windows side by side unless a range was asked for.
std::string draw(const std::string& title, const std::string& subtitle,
                 const std::vector<DrawnSpectrum>& spectra, const BandRange& range,
                 const char* radiance_title) {
  struct Window {
    double min_um, max_um;
  };
  std::vector<Window> windows = {{3, 5.5}, {7.5, 14}};
  if (range.lambda_min_um > 3 || range.lambda_max_um < 14) {
    windows = {{range.lambda_min_um, range.lambda_max_um}};
  }
  std::vector<CurvePanel> panels;
  for (const bool radiance : {false, true}) {
    for (const Window& w : windows) {
      CurvePanel panel{radiance ? radiance_title : "Transmittance",
                       "Wavelength in \u00b5m",
                       radiance ? "W/(m\u00b2 sr \u00b5m)" : "Mean over 10 cm\u207b\u00b9",
                       {},
                       0,
                       radiance ? 0.0 : 1.0};
      for (const DrawnSpectrum& s : spectra) {
        const AirSpectrum& value = radiance ? s.radiance_w_m2_sr_um : s.transmittance;
        if (!value.empty()) panel.curve.push_back(curve_of(s.name, value, w.min_um, w.max_um));
      }
      if (!panel.curve.empty()) panels.push_back(std::move(panel));
    }
  }
  return plot_curves(title, subtitle, panels, windows.size());
}

// ---- show atmosphere

struct AtmosphereCommand {
  explicit AtmosphereCommand(CLI::App& command) : air(command), output(command, kAirFormats) {
    command.add_option("--observer-height-m,--observer-m", observer_height_m, "Above the sea")
        ->required();
    command.add_option("--target-height-m,--target-m", target_height_m,
                       "Above the sea; not with --level");
    command
        .add_option("--range-m", range_m,
                    "Range as seen from the sensor along the straight line; 0 to 1e6")
        ->type_name("R")
        ->required();
    command.add_flag("--level", level,
                     "A path that follows the Earth's curvature at the observer's height, as other "
                     "codes have it");
    sun.add_to(command, "--sun-from-path-deg",
               "From the path's direction, clockwise: 0 looks towards the sun");
    command.add_option("--surroundings-temperature-k", surroundings_temperature_k,
                       "Blackbody around the path, whose radiation is scattered into it; default: "
                       "sky and surface as a run has them, the surface as warm as the air without "
                       "--sweep-file; 0: none");
    command
        .add_option("--modtran", modtran_file,
                    "Another code's output (tape7, .7sc or CSV) of this line of sight, shown "
                    "beside ours")
        ->type_name("FILE");
    command.add_option("--modtran-name", modtran_name,
                       "What the drawing calls it; default MODTRAN");
    bands.add_to(command);
  }

  AirOptions air;
  OutputOptions output;
  SunOptions sun;
  BandRange bands;
  double observer_height_m = 0, range_m = 0;
  std::optional<double> target_height_m, surroundings_temperature_k;
  bool level = false;
  std::string modtran_file, modtran_name = "MODTRAN";

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(const auto chosen, air.choose());
    RETURN_IF_ERROR(bands.check());
    RETURN_IF_ERROR(check_line_of_sight());
    ASSIGN_OR_RETURN(const auto sun_place, sun.place(0));
    std::optional<AirSpectrum> surroundings;
    if (surroundings_temperature_k) {
      if (is_fog(chosen.weather.air.aerosol.kind))
        return absl::InvalidArgumentError(
            "--surroundings-temperature-k has no meaning in fog, whose particles scatter the fog's "
            "own light; leave it out");
      RETURN_IF_ERROR(
          check_number("--surroundings-temperature-k", *surroundings_temperature_k, 0, 400));
      surroundings.emplace();
      for (std::size_t b = 0; b<kAirBandCount&& * surroundings_temperature_k> 0; ++b) {
        surroundings->push_back(
            planck_radiance_w_m2_sr_um(air_band_lambda_um(b), *surroundings_temperature_k));
      }
    }
    ASSIGN_OR_RETURN(const auto air_light,
                     WeatherAir::make(chosen.weather, target_height_m.value_or(observer_height_m)));
    const auto ray = [&](const AirProfile& profile) {
      return line_of_sight(profile, chosen.weather.refraction);
    };
    ASSIGN_OR_RETURN(const auto ours, air_light.radiance(WeatherAir::Sight::kSharp, ray, sun_place,
                                                         surroundings ? &*surroundings : nullptr));
    warn_of_scattering(ours);

    ASSIGN_OR_RETURN(const auto other, imported());
    return output.write([&](std::string_view format, std::ostream& out) -> absl::Status {
      if (format != "svg") return write(ours, other, format, out);
      std::vector<DrawnSpectrum> spectra = {{"irsig", ours.transmittance, ours.total_w_m2_sr_um}};
      if (other.has_value()) {
        spectra.push_back({modtran_name, other->transmittance, other->radiance_w_m2_sr_um});
      }
      out << draw(absl::StrFormat(level ? "Level path of %g km at %g m" : "%g km from %g m",
                                  range_m / 1000, observer_height_m) +
                      (level ? "" : absl::StrFormat(" to %g m", *target_height_m)),
                  chosen.title, spectra, bands, "Path radiance");
      return absl::OkStatus();
    });
  }

 private:
  [[nodiscard]] absl::Status check_line_of_sight() const {
    for (const absl::Status& s :
         {check_number("--observer-height-m", observer_height_m, 0, 1e8),
          check_number("--target-height-m", target_height_m.value_or(0), 0, 1e8),
          check_number("--range-m", range_m, 0, level ? 1e6 : 1e8)}) {
      if (!s.ok()) return s;
    }
    if (level == target_height_m.has_value()) {
      return absl::InvalidArgumentError(
          level ? "--level has one height, --observer-height-m; --target-height-m contradicts it"
                : "--target-height-m is missing (or --level, for one height all along)");
    }
    return absl::OkStatus();
  }

  [[nodiscard]] absl::StatusOr<LightPath> line_of_sight(const AirProfile& profile,
                                                        bool refraction) const {
    if (level) return level_path(observer_height_m, range_m);
    return look_between(profile, observer_height_m, *target_height_m, range_m, refraction);
  }

  // Returns the imported path of the other radiative transfer code for this line of sight.
  [[nodiscard]] absl::StatusOr<std::optional<ImportedPath>> imported() const {
    if (modtran_file.empty()) return std::optional<ImportedPath>();
    const auto text = read_user_file(modtran_file, kMostTableBytes);
    if (!text.ok()) {
      return absl::NotFoundError(absl::StrCat(modtran_file, ": ", text.status().message()));
    }
    ASSIGN_OR_RETURN(const auto paths, parse_imported_paths(*text, modtran_file));
    ASSIGN_OR_RETURN(
        const auto found,
        find_path(paths, observer_height_m, target_height_m.value_or(observer_height_m), range_m));
    return std::optional(*found);
  }

  [[nodiscard]] absl::Status write(const PathRadiance& ours,
                                   const std::optional<ImportedPath>& other,
                                   std::string_view format, std::ostream& out) const {
    std::vector<std::string> heads = {"wavenumber_cm1",
                                      "lambda_um",
                                      "transmittance",
                                      "thermal_radiance_w_m2_sr_um",
                                      "scattered_radiance_w_m2_sr_um",
                                      "path_radiance_w_m2_sr_um",
                                      "model_error_transmittance",
                                      "model_error_path_radiance_w_m2_sr_um"};
    const bool radiance = other && !other->radiance_w_m2_sr_um.empty();
    if (other) heads.emplace_back("imported_transmittance");
    if (radiance) heads.emplace_back("imported_path_radiance_w_m2_sr_um");
    const auto cell = [](double v) { return std::isnan(v) ? Cell() : Cell(v); };
    std::vector<std::vector<Cell>> rows;
    for (std::size_t b = kAirBandCount; b-- > 0;) {
      if (!bands.has(b)) continue;
      rows.push_back({air_band_centre_cm1(b), air_band_lambda_um(b), ours.transmittance[b],
                      ours.thermal_w_m2_sr_um[b], ours.scattered_w_m2_sr_um[b],
                      ours.total_w_m2_sr_um[b], ours.model_error_transmittance[b],
                      ours.model_error_w_m2_sr_um[b]});
      if (other) rows.back().push_back(cell(other->transmittance[b]));
      if (radiance) rows.back().push_back(cell(other->radiance_w_m2_sr_um[b]));
    }
    return write_table(heads, rows, format, out);
  }
};

// ---- show sky

struct SkyCommand {
  explicit SkyCommand(CLI::App& command) : air(command), output(command, kAirFormats) {
    command.add_option("--altitude-m", height_m, "Altitude of the sensor above the sea")
        ->required();
    command
        .add_option(
            "--zenith-deg", zenith_deg,
            "Directions, separated by commas: 0 up, 90 horizontal, to 180 (the air in front "
            "of the surface)")
        ->required()
        ->delimiter(',');
    command
        .add_option("--azimuth-deg", azimuth_deg,
                    "Azimuths, separated by commas, each with every zenith angle; default 0")
        ->delimiter(',');
    sun.add_to(command, "--sun-azimuth-deg", "As --azimuth-deg, clockwise from north");
    bands.add_to(command);
  }

  AirOptions air;
  OutputOptions output;
  SunOptions sun;
  BandRange bands;
  double height_m = 0;
  std::vector<double> zenith_deg, azimuth_deg = {0};

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(const auto chosen, air.choose());
    RETURN_IF_ERROR(bands.check());
    RETURN_IF_ERROR(check_number("--altitude-m", height_m, 0, 1e8));
    for (const double zenith : zenith_deg) {
      RETURN_IF_ERROR(check_number("--zenith-deg", zenith, 0, 180));
    }
    std::vector<std::vector<Cell>> rows;
    std::vector<DrawnSpectrum> spectra;
    ASSIGN_OR_RETURN(const auto air_light, WeatherAir::make(chosen.weather, height_m));
    for (const double azimuth : azimuth_deg) {
      for (const double zenith : zenith_deg) {
        ASSIGN_OR_RETURN(const auto sun_place, sun.place(azimuth));
        const auto ray = [&](const AirProfile& profile) -> absl::StatusOr<LightPath> {
          return look(profile, height_m, zenith, std::numeric_limits<double>::infinity(),
                      chosen.weather.refraction);
        };
        ASSIGN_OR_RETURN(const auto sky,
                         air_light.radiance(WeatherAir::Sight::kDiffuse, ray, sun_place));
        warn_of_scattering(sky);
        append(rows, zenith, azimuth, sky);
        spectra.push_back(
            {absl::StrFormat("%g\u00b0", zenith) +
                 (azimuth_deg.size() > 1 ? absl::StrFormat(", %g\u00b0", azimuth) : ""),
             sky.transmittance, sky.total_w_m2_sr_um});
      }
    }
    return output.write([&](std::string_view format, std::ostream& out) {
      if (format != "svg")
        return write_table(
            {"zenith_deg", "azimuth_deg", "wavenumber_cm1", "lambda_um", "transmittance",
             "thermal_radiance_w_m2_sr_um", "scattered_radiance_w_m2_sr_um",
             "sky_radiance_w_m2_sr_um", "model_error_sky_radiance_w_m2_sr_um"},
            rows, format, out);
      out << draw(absl::StrFormat("The sky from %g m, by zenith angle", height_m), chosen.title,
                  spectra, bands, "Sky radiance");
      return absl::OkStatus();
    });
  }

 private:
  void append(std::vector<std::vector<Cell>>& rows, double zenith, double azimuth,
              const PathRadiance& sky) const {
    for (std::size_t b = kAirBandCount; b-- > 0;) {
      if (!bands.has(b)) continue;
      rows.push_back({zenith, azimuth, air_band_centre_cm1(b), air_band_lambda_um(b),
                      sky.transmittance[b], sky.thermal_w_m2_sr_um[b], sky.scattered_w_m2_sr_um[b],
                      sky.total_w_m2_sr_um[b], sky.model_error_w_m2_sr_um[b]});
    }
  }
};

// ---- show sun

struct SunCommand {
  explicit SunCommand(CLI::App& command) : air(command), output(command, {"csv", "json", "text"}) {
    command.add_option("--latitude-deg", latitude_deg,
                       "North positive; with --sweep-file: its place's");
    command.add_option("--longitude-deg", longitude_deg,
                       "East positive; with --sweep-file: its place's");
    command.add_option("--altitude-m", height_m,
                       "Altitude above the WGS 84 ellipsoid; with --sweep-file: its place's");
    command.add_option(
        "--time", time,
        "RFC 3339 with offset: 2025-12-21T10:30:00+09:00; with --sweep-file: the season's "
        "first");
    bands.add_to(command);
  }

  AirOptions air;
  OutputOptions output;
  BandRange bands;
  std::optional<double> latitude_deg, longitude_deg, height_m;
  std::string time;

  [[nodiscard]] absl::Status run() const {
    std::optional<ChosenAir> chosen;
    if (air.given()) {
      ASSIGN_OR_RETURN(chosen, air.choose());
    }
    ASSIGN_OR_RETURN(const auto where, place(chosen));
    ASSIGN_OR_RETURN(const auto utc, parse_rfc3339(where.time));
    ASSIGN_OR_RETURN(const auto sun,
                     sun_position(utc, where.latitude_deg, where.longitude_deg, where.height_m));
    std::vector<std::string> heads = {"sun_azimuth_deg", "sun_zenith_deg", "sun_distance_au"};
    const std::vector<Cell> position = {sun.azimuth_deg, sun.zenith_deg, sun.distance_au};
    std::vector<std::vector<Cell>> rows = {position};
    const auto write = [&] {
      return output.write([&](std::string_view format, std::ostream& out) {
        return write_table(heads, rows, format, out);
      });
    };
    if (!chosen) return write();
    RETURN_IF_ERROR(bands.check());
    RETURN_IF_ERROR(check_number("--altitude-m", where.height_m, 0, 1e8));
    ASSIGN_OR_RETURN(const auto air_light, WeatherAir::make(chosen->weather, where.height_m));
    const AirSpectrum here = air_light.sun_irradiance_w_m2_um(
        where.height_m, SunPlace{sun.zenith_deg, 0, sun.distance_au});
    for (const char* more : {"wavenumber_cm1", "lambda_um", "sun_irradiance_w_m2_um",
                             "sun_irradiance_in_space_w_m2_um"})
      heads.emplace_back(more);
    rows.clear();
    for (std::size_t b = kAirBandCount; b-- > 0;) {
      if (!bands.has(b)) continue;
      const double lambda_um = air_band_lambda_um(b);
      std::vector<Cell> row = position;
      row.insert(row.end(),
                 {air_band_centre_cm1(b), lambda_um, here[b],
                  solar_irradiance_w_m2_um(lambda_um) / (sun.distance_au * sun.distance_au)});
      rows.push_back(std::move(row));
    }
    return write();
  }

 private:
  // Returns the place and time of the options; values that no option gives are those of the sweep.
  [[nodiscard]] absl::StatusOr<ChosenAir::Place> place(
      const std::optional<ChosenAir>& chosen) const {
    const bool sweep = chosen && chosen->place;
    for (const auto& [given, name] :
         {std::pair{latitude_deg.has_value(), "--latitude-deg"},
          std::pair{longitude_deg.has_value(), "--longitude-deg"},
          std::pair{height_m.has_value(), "--altitude-m"}, std::pair{!time.empty(), "--time"}}) {
      if (!given && !sweep) return absl::InvalidArgumentError(absl::StrCat(name, " is missing"));
    }
    const ChosenAir::Place silent = sweep ? *chosen->place : ChosenAir::Place{};
    return ChosenAir::Place{latitude_deg.value_or(silent.latitude_deg),
                            longitude_deg.value_or(silent.longitude_deg),
                            height_m.value_or(silent.height_m), time.empty() ? silent.time : time};
  }
};

template <typename Command>
void add(CLI::App& show, int& exit_code, const char* name, const char* about) {
  CLI::App* command = show.add_subcommand(name, about);
  const auto given = std::make_shared<Command>(*command);
  const std::string prefix = absl::StrCat("show ", name, ": ");
  command->callback([given, prefix, &exit_code] {
    const absl::Status status = given->run();
    // Errors in files begin with the file's name; those of options say which command it was.
    const bool of_option = absl::StrCat(status.message()).starts_with("--");
    exit_code = report(status.ok() || !of_option
                           ? status
                           : absl::Status(status.code(), absl::StrCat(prefix, status.message())));
  });
}

}  // namespace

void add_show_atmosphere(CLI::App& show, int& exit_code) {
  add<AtmosphereCommand>(show, exit_code, "atmosphere",
                         "Transmittance and radiance of a path through the air, 2.94 to 15.4 um");
  add<SkyCommand>(show, exit_code, "sky", "Radiance of the sky in some directions");
  add<SunCommand>(show, exit_code, "sun",
                  "Where the sun is, without refraction; with air: its direct light, normal to the "
                  "beam");
}

}  // namespace irsig
