#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "core/sources/emission.h"

namespace irsig {

enum class TemperatureUnit : std::uint8_t { kKelvin, kCelsius, kFahrenheit };
enum class FieldMatch : std::uint8_t { kIndex, kCentroid };

// Outdoors, and on whatever burns. A value beyond them is a unit that was mistaken.
inline constexpr double kColdestFieldK = 100, kHottestFieldK = 5000;

// Interpretation of a file's values.
struct FieldImport {
  std::string file_name;  // for messages; its ending says the format: .csv, .ply
  TemperatureUnit unit = TemperatureUnit::kKelvin;
  FieldMatch match = FieldMatch::kIndex;
  double max_distance_m = 0;      // of a value's place from its facet's centroid
  std::optional<double> error_k;  // of values that state none
};

// The mesh that a field is matched to, in the coordinates in which the file gives places.
struct FieldMesh {
  std::vector<std::array<double, 3>> vertex;
  std::vector<std::array<std::uint32_t, 3>> triangle;
  double unit_m = 1;  // of these coordinates

  [[nodiscard]] std::array<double, 3> centroid(std::size_t facet) const;
};

// Temperatures of facets at one or more instants. [time][facet]; NaN: the file has none
struct TemperatureField {
  std::vector<double> unix_s;  // increasing; one alone, without a time: at all times
  bool at_all_times = false;
  std::vector<FacetTemperatures> at;
};

// Reads a field from CSV or PLY. CSV: a header and one row for each value. Columns: `facet` (index)
// or `vertex`, counted from 0,
// or `x`, `y`, `z`; `temperature`; optional `error` (K, or F for degF) and `time` (RFC 3339). Lines
// that start with # are remarks, and so are the columns `part` and `season`. PLY: text or binary,
// vertices or faces with a property `temperature`, and perhaps `error`.
//
// A value of a vertex counts for its facets: a facet has the mean of its three, with what the three
// differ from it as its error. By index: in the order of the model's file, polygons cut into
// triangles. By centroid: each facet has the value that is nearest to its centroid; of vertices:
// each vertex the nearest.
//
// INVALID_ARGUMENT, up to ten at once, as file:line:column where there is a line: what is no
// number, unknown columns, an index beyond the mesh, a value that comes twice, values below
// kColdestFieldK or above kHottestFieldK (with the unit that they suggest), a value without an
// error where no error_k is stated.
[[nodiscard]] absl::StatusOr<TemperatureField> read_temperature_field(std::string_view bytes,
                                                                      const FieldImport& how,
                                                                      const FieldMesh& mesh);

// Returns the temperatures at an instant: linear between two of the field's, with up to a quarter
// of the change between them as an error beside their own (an estimate: the curve is not known).
// OUT_OF_RANGE: before the first, after the last.
[[nodiscard]] absl::StatusOr<FacetTemperatures> at_time(const TemperatureField& field,
                                                        double unix_s);

}  // namespace irsig
