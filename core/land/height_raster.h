#pragma once

#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/map_coordinates.h"
#include "core/land/height_field.h"

namespace irsig {

// Heights beyond this are refused: such numbers mean that a height is missing.
inline constexpr double kMostHeightM = 1e5;

// Coordinates of a raster: the system in which its samples lie.
struct LocalMetres {};        // x and y of the land's local frame
struct GeographicDegrees {};  // longitude and latitude on WGS 84 (EPSG 4326)
using MapSystem = std::variant<LocalMetres, GeographicDegrees, UtmZone>;

// Returns the map system of an EPSG code. INVALID_ARGUMENT: a system other than EPSG 4326, 32601 to
// 32660 and 32701 to 32760.
[[nodiscard]] absl::StatusOr<MapSystem> map_system(std::uint64_t epsg);

// Heights as a file has them. Sample (column, row) lies at x = x0 + column x_step,
// y = y0 + row y_step; its height is height_m[row columns + column].
struct HeightRaster {
  MapSystem system;
  double x0 = 0, y0 = 0;                // of sample (0, 0)
  double x_step = 0, y_step = 0;        // y_step < 0: rows from the north
  std::uint32_t columns = 0, rows = 0;  // samples
  std::vector<float> height_m;          // above the geoid; NaN: missing
};

// Reads an SRTM tile: 1201 x 1201 or 3601 x 3601 big-endian 16-bit integers, rows from the north,
// -32768 where a height is missing. The file's name states its southwest corner (N46E007.hgt).
// INVALID_ARGUMENT: "file: reason; remedy".
[[nodiscard]] absl::StatusOr<HeightRaster> read_hgt(std::string_view bytes, std::string_view file);

// Reads an ESRI ASCII grid: ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize
// and perhaps nodata_value, then rows of heights from the north. The file does not state the system
// of its coordinates. INVALID_ARGUMENT: "file:line:column: reason; remedy". Takes memory in
// proportion to the text, whatever size its header states.
[[nodiscard]] absl::StatusOr<HeightRaster> read_asc(std::string_view text, std::string_view file,
                                                    const MapSystem& system);

// Returns such a grid, whose numbers are read back as they were. Requires y_step = -x_step.
[[nodiscard]] std::string write_asc(const HeightRaster& raster);

}  // namespace irsig
