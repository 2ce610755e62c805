#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/absorber_amounts.h"

namespace irsig {

// Transmittance and path radiance of lines of sight that another code computed.
//
// tape7 and .7sc-style text (MODTRAN 4-5, LOWTRAN 7): IEMSCT 0 (transmittance alone), 1 (thermal
// radiance), 2 (and scattered sunlight), 3 (direct solar irradiance); spectra against wavenumber or
// wavelength; several runs one after the other in a file. Which columns and cards, and the CSV:
// docs/explanation/methods/atmosphere.md, "Imported paths". A path to space has infinite range and
// target height.
struct ImportedPath {
  // Facts that the file states about its path; a quantity that it does not state is NaN.
  double observer_height_m, target_height_m, range_m, zenith_deg;
  double sun_zenith_deg, latitude_deg, longitude_deg, ground_temperature_k;
  int day_of_year;  // 0: not stated
  // Means over the air's bands (absorber_amounts.h); NaN where the file has no value.
  AirSpectrum transmittance;
  AirSpectrum radiance_w_m2_sr_um;  // empty: the file has transmittance alone
  AirSpectrum sun_w_m2_um;          // empty: not IEMSCT 3
  std::size_t line = 0;             // of the file, where the run begins
};

struct ImportedPaths {
  std::string file;
  std::vector<ImportedPath> path;
};

// Parses imported paths. INVALID_ARGUMENT lists every error as file:line:column: ...
[[nodiscard]] absl::StatusOr<ImportedPaths> parse_imported_paths(std::string_view text,
                                                                 std::string_view file);

// Facts of a sweep's condition, for comparison with an import. NaN: not stated.
struct ConditionFacts {
  double sun_zenith_deg, latitude_deg, longitude_deg, ground_temperature_k;
  int day_of_year;
};
// Checks that the paths were computed for a condition, within 0.5 deg of the sun, 0.1 deg of the
// place, 3 days and 1 K. FAILED_PRECONDITION names both values of each larger difference.
[[nodiscard]] absl::Status check_conditions(const ImportedPaths& paths,
                                            const ConditionFacts& facts);

// Both ends of a line of sight may be this far above or below a level path that stands for it.
inline constexpr double kLevelHeightM = 30;

// Finds the path of a geometry: heights and range within 2 % or 1 m, else a level path of that
// range near it. NOT_FOUND names the geometries that are covered.
[[nodiscard]] absl::StatusOr<const ImportedPath*> find_path(const ImportedPaths& paths,
                                                            double observer_height_m,
                                                            double target_height_m, double range_m);

}  // namespace irsig
