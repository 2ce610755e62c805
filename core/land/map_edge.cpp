#include "core/land/map_edge.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

struct MapSides {
  double west_m, east_m, south_m, north_m;
  explicit MapSides(const HeightGrid& map)
      : west_m(map.west_m),
        east_m(map.west_m + map.columns * map.spacing_m),
        south_m(map.south_m),
        north_m(map.south_m + map.rows * map.spacing_m) {}
  // The distance of a point within the map to the nearest side.
  [[nodiscard]] double distance_m(double x_m, double y_m) const {
    return std::min({x_m - west_m, east_m - x_m, y_m - south_m, north_m - y_m});
  }
};

// visit(x, y, z) of each vertex, whose z it may change.
template <typename Grid, typename Visit>
void for_each_vertex(Grid& grid, Visit&& visit) {
  auto z = grid.z_m.begin();
  for (std::uint32_t row = 0; row <= grid.rows; ++row)
    for (std::uint32_t column = 0; column <= grid.columns; ++column, ++z)
      visit(grid.west_m + column * grid.spacing_m, grid.south_m + row * grid.spacing_m, *z);
}

absl::StatusOr<double> surface_at_origin(const HeightField& land) {
  const auto out = land.z_m(0, 0);
  if (!out) return absl::InvalidArgumentError("the target's place lies beyond the map");
  return *out;
}

}  // namespace

double level_z_m(const GeodeticPosition& origin, double surface_m, double x_m, double y_m) {
  const double expected_m = origin.height_m + surface_m;
  double z_m = surface_m - (x_m * x_m + y_m * y_m) / (2 * kEarthRadiusM);
  for (int round = 0; round < 8; ++round) {  // each gains a factor of 100 at least
    const double change_m = expected_m - height_m(origin, {x_m, y_m, z_m});
    z_m += change_m;
    if (std::abs(change_m) < 1e-4) break;
  }
  return z_m;
}

absl::StatusOr<std::vector<EdgeStep>> edge_steps(const HeightField& land,
                                                 const GeodeticPosition& origin) {
  ASSIGN_OR_RETURN(const double surface_m, surface_at_origin(land));
  const HeightGrid& map = land.outer();
  std::vector<EdgeStep> out;
  const auto add = [&](std::uint32_t column, std::uint32_t row) {
    EdgeStep at{.x_m = map.west_m + column * map.spacing_m,
                .y_m = map.south_m + row * map.spacing_m,
                .land_z_m = map.z_m[std::size_t{row} * (map.columns + std::size_t{1}) + column]};
    at.ground_z_m = level_z_m(origin, surface_m, at.x_m, at.y_m);
    if (std::abs(at.land_z_m - at.ground_z_m) > kMostEdgeStepM) out.push_back(at);
  };
  for (std::uint32_t column = 0; column <= map.columns; ++column)
    for (const std::uint32_t row : {0U, map.rows}) add(column, row);
  for (std::uint32_t row = 1; row < map.rows; ++row)
    for (const std::uint32_t column : {0U, map.columns}) add(column, row);
  return out;
}

absl::StatusOr<HeightField> fade_edge(HeightField land, const GeodeticPosition& origin,
                                      double width_m) {
  if (width_m == 0) return land;
  ASSIGN_OR_RETURN(const double surface_m, surface_at_origin(land));
  const MapSides sides(land.outer());
  const double spacing_m = land.outer().spacing_m, most_m = sides.distance_m(0, 0) - spacing_m;
  if (!(width_m > 0 && width_m <= most_m))
    return absl::InvalidArgumentError(absl::StrCat(
        "a fade over ", width_m, " m reaches the target, whose place lies ",
        absl::SixDigits(most_m + spacing_m), " m from the edge of the map; expected at most ",
        absl::SixDigits(std::max(0.0, std::floor(most_m))),
        " m (a cell less), or a map that reaches farther"));
  const auto faded = [&](HeightGrid grid) {
    for_each_vertex(grid, [&](double x_m, double y_m, float& z_m) {
      const double u = std::max(0.0, sides.distance_m(x_m, y_m) / width_m);
      if (u >= 1) return;
      const double level_m = level_z_m(origin, surface_m, x_m, y_m);
      z_m = static_cast<float>(level_m + u * u * (3 - 2 * u) * (double{z_m} - level_m));
    });
    return grid;
  };
  std::optional<HeightGrid> inset;
  if (land.inset() != nullptr) inset = faded(*land.inset());
  return HeightField::create(faded(land.outer()), std::move(inset));
}

}  // namespace irsig
