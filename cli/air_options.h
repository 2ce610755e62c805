#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/atmosphere/atmosphere.h"
#include "core/environment/weather_spec.h"
#include "schema/sweep.pb.h"

namespace irsig {

// An atmosphere, as the command line describes it.
struct ChosenAir {
  Atmosphere atmosphere;  // without a cloud
  // Air and cloud of the weather. Its surface is the season's with --sweep-file; else black ground
  // as warm as the air above it.
  WeatherSpec weather;
  std::string title;  // for a plot

  // The sweep's place, with --sweep-file, and the time of the season's first condition.
  struct Place {
    double latitude_deg, longitude_deg, height_m;
    std::string time;
  };
  std::optional<Place> place;
};

// Options that describe an atmosphere, directly or by a sweep; `irsig show atmosphere`, `sky` and
// `sun` share them.
class AirOptions {
 public:
  // kHotGas: --temperature-k is the command's own option; --air-temperature-k alone is the air's.
  // There are no options for a cloud, which `show gas` leaves out.
  enum class Use { kLight, kHotGas };
  explicit AirOptions(CLI::App& command, Use use = Use::kLight);

  // Returns true if any of the options was given.
  [[nodiscard]] bool given() const;

  // Returns the chosen air. INVALID_ARGUMENT: names the options that are missing, contradict each
  // other or are out of range.
  [[nodiscard]] absl::StatusOr<ChosenAir> choose() const;

 private:
  [[nodiscard]] absl::StatusOr<ChosenAir> of_sweep() const;
  [[nodiscard]] absl::StatusOr<AirProfile> profile() const;
  [[nodiscard]] absl::StatusOr<AerosolSpec> aerosol() const;
  void add_cloud_options();
  // Sets the cloud of the weather that the options describe.
  [[nodiscard]] absl::Status set_cloud(WeatherSpec& weather) const;

  CLI::Option_group* group_;
  std::string sweep_, season_;
  std::string profile_, profile_file_, aerosol_;
  std::optional<double> visibility_m_, air_temperature_k_, relative_humidity_percent_, pressure_pa_;
  std::optional<double> wind_speed_m_s_, wind_speed_24h_m_s_, air_mass_, co2_ppmv_;
  schema::Cloud cloud_;  // keys that are not stated are absent
  bool straight_ = false, winter_troposphere_ = false;
};

}  // namespace irsig
