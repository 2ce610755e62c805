#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/store/tables/name_set.h"

// The questions that a reader (reader.h) answers.

namespace irsig {

// A quantity of a signature (sql/query.sql has the same numbers).
enum class SignatureQuantity : int {
  kIntensity = 0,  // of the source
  kApparentIntensity = 1,
  kContrastIntensity = 2,
  kBackgroundRadiance = 3
};

// Filters of a query; an empty string or set means "any".
struct SignatureFilter {
  std::string sweep;
  NameSet season;
  std::string time_utc, band;
  // Numerical error / |value| of this quantity (of the background radiance: its standard error).
  std::optional<double> max_relative_error;
  SignatureQuantity error_of = SignatureQuantity::kIntensity;
  // Aspect filters: at most one. nearest: the signatures of the `nearest` closest viewpoints that
  // have one passing the other filters; within: inside a cap, its edge (to 1e-9 deg) included. A
  // direction alone only orders.
  struct Direction {
    double aspect_azimuth_deg, aspect_elevation_deg;
  };
  std::optional<Direction> direction;
  std::uint32_t nearest = 0;
  std::optional<double> within_deg;
  std::optional<std::uint64_t> row;
  std::optional<double> range_m;  // of the viewpoint, to 1e-9 of it
};

// One condition and band at one range: all fields must be given.
struct ValueFilter {
  std::string sweep, season, time_utc, band;
  double range_m = 0;
  SignatureQuantity quantity = SignatureQuantity::kIntensity;
};

// Filters of profiles; an empty string or set means "any".
struct ProfileFilter {
  std::string sweep;
  NameSet season;
  std::string band, profile;
};

// Filters of computed temperatures; an empty string or set means "any".
struct TemperatureFilter {
  std::string sweep;
  NameSet season;
  std::string time_utc;
};

// Files of a sweep that are read with it. A damaged file is an error only if the caller requests
// it.
enum class SweepFiles { kNone, kTemperatures, kAll };

}  // namespace irsig
