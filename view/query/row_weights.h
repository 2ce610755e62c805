#pragma once

#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/query/query.h"

namespace irsig {

// Weights of rows by a user's own table: a CSV file with the column `weight` (0 or more) and
//
//   aspect_azimuth_deg, aspect_elevation_deg   a direction; its weight goes to the nearest aspect
// or any of
//   season, time_utc, range_m                  rows that have all of these
struct RowWeights {
  struct Line {
    std::size_t line;  // of the file
    std::string season, time_utc;
    double range_m, azimuth_deg, elevation_deg;
    double weight;
  };
  std::string file;
  bool of_aspects, has_season, has_time, has_range;
  std::vector<Line> line;
};

// Reads weights from a file. INVALID_ARGUMENT, each file:line:column: unknown columns, a text that
// is not a number, the same place twice, no weight above 0.
[[nodiscard]] absl::StatusOr<RowWeights> read_row_weights(const std::string& path);

// Direction of an aspect, for weights_of_aspects(): an aspect has the weights of the directions of
// the table to which it is the nearest.
struct AspectDeg {
  double azimuth, elevation;
};
[[nodiscard]] std::vector<double> weights_of_aspects(const RowWeights& table,
                                                     std::span<const AspectDeg> aspect);

// Returns the weight of a condition and range. INVALID_ARGUMENT: the table has no line for it.
[[nodiscard]] absl::StatusOr<double> weight_of(const RowWeights& table, const StoredSignature& row);

}  // namespace irsig
