#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/atmosphere/atmosphere.h"
#include "core/environment/environment.h"

namespace irsig {

// An atmosphere, as the command line describes it.
struct ChosenAir {
  Atmosphere atmosphere;
  bool refraction = true;
  std::string title;  // for a plot
  // The season's surface with --sweep; else black ground as warm as the air above it.
  SurfaceBoundary lower;

  // Mean radiance of sky and surface around a point at this height above the sea, as a run scatters
  // it into its paths. [band of the air]
  [[nodiscard]] absl::StatusOr<AirSpectrum> surroundings_w_m2_sr_um(double height_m) const;
  // The sweep's place, with --sweep, and the time of the season's first condition.
  struct Place {
    double latitude_deg, longitude_deg, height_m;
    std::string time;
  };
  std::optional<Place> place;
};

// The options that describe an atmosphere, by themselves or as a sweep has it: `irsig show
// atmosphere`, `sky` and `sun` share them.
class AirOptions {
 public:
  // own_temperature: --temperature-k is the command's own, the air's is --air-temperature-k alone.
  explicit AirOptions(CLI::App& command, bool own_temperature = false);

  // Returns true if any of the options was given.
  [[nodiscard]] bool given() const;

  // INVALID_ARGUMENT names the options that are missing, contradict each other or are out of range.
  [[nodiscard]] absl::StatusOr<ChosenAir> choose() const;

 private:
  [[nodiscard]] absl::StatusOr<ChosenAir> of_sweep() const;
  [[nodiscard]] absl::StatusOr<AirProfile> profile() const;
  [[nodiscard]] absl::StatusOr<AerosolSpec> aerosol() const;

  CLI::Option_group* group_;
  std::string sweep_, season_;
  std::string profile_, profile_file_, aerosol_;
  std::optional<double> visibility_m_, air_temperature_k_, relative_humidity_percent_, pressure_pa_;
  std::optional<double> wind_speed_m_s_, wind_speed_24h_m_s_, air_mass_, co2_ppmv_;
  bool straight_ = false, winter_troposphere_ = false;
};

}  // namespace irsig
