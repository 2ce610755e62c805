#include "core/land/height_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/check.h"
#include "core/base/status_macros.h"
#include "core/land/height_tile.h"
#include "core/land/height_walk.h"

namespace irsig {
namespace {

constexpr double kMostDistance = 1e9;
constexpr double kMostCoordinateM = 1e7;
constexpr double kDepartureM = 1e-6;  // rounding of a hit 1e5 m from the origin: 1e-10 m

absl::Status check_grid(const HeightGrid& grid) {
  if (grid.columns == 0 || grid.rows == 0)
    return absl::InvalidArgumentError("a grid of heights needs at least 2 x 2 vertices");
  const std::uint64_t vertices = (grid.columns + std::uint64_t{1}) * (grid.rows + std::uint64_t{1});
  if (std::max(grid.columns, grid.rows) >= kMostLandVertices || vertices > kMostLandVertices)
    return absl::InvalidArgumentError(absl::StrCat(
        "a grid of ", grid.columns + std::uint64_t{1}, " x ", grid.rows + std::uint64_t{1},
        " vertices is above the limit of ", kMostLandVertices,
        " (memory); use a larger spacing, and an inset where detail matters"));
  if (grid.z_m.size() != vertices)
    return absl::InvalidArgumentError(
        absl::StrCat(grid.z_m.size(), " heights for ", vertices, " vertices"));
  const double east_m = grid.west_m + grid.columns * grid.spacing_m;
  const double north_m = grid.south_m + grid.rows * grid.spacing_m;
  for (const double edge_m : {grid.west_m, grid.south_m, east_m, north_m})
    if (!(std::abs(edge_m) <= kMostCoordinateM) || !(grid.spacing_m >= 1e-3))
      return absl::InvalidArgumentError(
          absl::StrCat("a grid with spacing ", grid.spacing_m, " m and an edge at ", edge_m,
                       " m; expected a spacing of at least 1 mm, and edges within 10000 km"));
  for (const float z : grid.z_m)
    if (!(std::abs(z) <= kMostCoordinateM))
      return absl::InvalidArgumentError(
          absl::StrCat("a height of ", z, " m, expected a number within 10000 km"));
  return absl::OkStatus();
}

// Number of cells of a length, if it is a whole number to 1e-6.
std::optional<int> whole_cells(double length_m, double spacing_m) {
  const double cells = length_m / spacing_m, whole = std::round(cells);
  if (!(std::abs(cells - whole) <= 1e-6) || std::abs(whole) > kMostLandVertices)
    return std::nullopt;
  return static_cast<int>(whole);
}

struct Seam {
  CellBlock cells;  // of the outer grid
  int fineness;     // inset cells along a side of an outer cell
};

absl::StatusOr<Seam> align(const HeightGrid& outer, const HeightGrid& inset) {
  const auto west = whole_cells(inset.west_m - outer.west_m, outer.spacing_m);
  const auto south = whole_cells(inset.south_m - outer.south_m, outer.spacing_m);
  const int fineness = whole_cells(outer.spacing_m, inset.spacing_m).value_or(0);
  const int columns = static_cast<int>(inset.columns), rows = static_cast<int>(inset.rows);
  if (!west || !south || fineness < 1 || columns % fineness != 0 || rows % fineness != 0)
    return absl::InvalidArgumentError(absl::StrCat(
        "the inset begins or ends between vertices of the map around it; its edges must lie on "
        "multiples of ",
        outer.spacing_m,
        " m from that map's southwest corner, and this spacing must be a multiple of the inset's"));
  const CellBlock cells{*west, *west + columns / fineness, *south, *south + rows / fineness};
  if (cells.west < 0 || cells.south < 0 || cells.east > static_cast<int>(outer.columns) ||
      cells.north > static_cast<int>(outer.rows))
    return absl::InvalidArgumentError("the inset reaches beyond the map around it");
  return Seam{cells, fineness};
}

// Moves the vertices of the inset's outermost edges onto the edges of the outer cells.
void join(const HeightTile& outer, const Seam& seam, HeightGrid& inset) {
  inset.spacing_m = outer.grid().spacing_m / seam.fineness;
  inset.west_m = outer.grid().west_m + seam.cells.west * outer.grid().spacing_m;
  inset.south_m = outer.grid().south_m + seam.cells.south * outer.grid().spacing_m;
  const auto on_edges = [&](int column, int row) {
    const int f = seam.fineness;
    const int i = std::min(column / f, seam.cells.east - seam.cells.west - 1);
    const int j = std::min(row / f, seam.cells.north - seam.cells.south - 1);
    const double u = column / double(f) - i, v = row / double(f) - j;
    const float* south = outer.corner(seam.cells.west + i, seam.cells.south + j);
    const float* north = south + outer.columns() + 1;
    inset.z_m[static_cast<std::size_t>(row) * (inset.columns + std::size_t{1}) +
              static_cast<std::size_t>(column)] =
        static_cast<float>((1 - v) * ((1 - u) * south[0] + u * south[1]) +
                           v * ((1 - u) * north[0] + u * north[1]));
  };
  const int columns = static_cast<int>(inset.columns), rows = static_cast<int>(inset.rows);
  for (int column = 0; column <= columns; ++column)
    for (const int row : {0, rows}) on_edges(column, row);
  for (int row = 0; row <= rows; ++row)
    for (const int column : {0, columns}) on_edges(column, row);
}

}  // namespace

struct HeightField::Tiles {
  HeightTile outer;
  std::optional<HeightTile> finer;
  HeightInset inset{};

  [[nodiscard]] const HeightInset* replaced() const { return finer ? &inset : nullptr; }
  // The tile at a point within the map.
  [[nodiscard]] const HeightTile& at(double x_m, double y_m) const {
    const HeightGrid& grid = outer.grid();
    const auto cell = [&](double from_m) { return static_cast<int>(from_m / grid.spacing_m); };
    return finer && inset.cells.contains(cell(x_m - grid.west_m), cell(y_m - grid.south_m)) ? *finer
                                                                                            : outer;
  }
  // The surface's height at a point within the map, or beyond its edge by rounding.
  [[nodiscard]] double z_m(double x_m, double y_m) const {
    return -HeightWalk(at(x_m, y_m), {x_m, y_m, 0}, {}).clearance_m(0);
  }
};

HeightField::HeightField(std::unique_ptr<const Tiles> tiles) : tiles_(std::move(tiles)) {}
HeightField::HeightField(HeightField&&) noexcept = default;
HeightField& HeightField::operator=(HeightField&&) noexcept = default;
HeightField::~HeightField() = default;

absl::StatusOr<HeightField> HeightField::create(HeightGrid outer, std::optional<HeightGrid> inset) {
  RETURN_IF_ERROR(check_grid(outer));
  auto tiles = std::make_unique<Tiles>(HeightTile(std::move(outer)));
  if (inset) {
    RETURN_IF_ERROR(check_grid(*inset));
    ASSIGN_OR_RETURN(const Seam seam, align(tiles->outer.grid(), *inset));
    join(tiles->outer, seam, *inset);
    tiles->outer.cover(seam.cells, *inset, seam.fineness);
    tiles->finer.emplace(std::move(*inset));
    tiles->inset = {&*tiles->finer, seam.cells};
  }
  return HeightField(std::move(tiles));
}

const HeightGrid& HeightField::outer() const { return tiles_->outer.grid(); }
const HeightGrid* HeightField::inset() const {
  return tiles_->finer ? &tiles_->finer->grid() : nullptr;
}
std::size_t HeightField::memory_bytes() const {
  return tiles_->outer.memory_bytes() + (tiles_->finer ? tiles_->finer->memory_bytes() : 0);
}

std::optional<double> HeightField::z_m(double x_m, double y_m) const {
  double begin = 0, end = 0;
  if (!HeightWalk(tiles_->outer, {x_m, y_m, 0}, {}).clip(begin, end)) return std::nullopt;
  return tiles_->z_m(x_m, y_m);
}

namespace {

// Returns the hit with its place in its triangle, and the normal.
LandHit described(const HeightTile& tile, const Crossing& at, Vec<Enu> point_m) {
  LandHit out{.distance = at.t,
              .inset = at.inset,
              .column = static_cast<std::uint32_t>(at.column),
              .row = static_cast<std::uint32_t>(at.row),
              .triangle = at.triangle};
  const HeightGrid& grid = tile.grid();
  const float* south = tile.corner(at.column, at.row);
  const float* north = south + tile.columns() + 1;
  const double u = std::clamp((point_m.x - grid.west_m) / grid.spacing_m - at.column, 0.0, 1.0);
  const double v = std::clamp((point_m.y - grid.south_m) / grid.spacing_m - at.row, 0.0, 1.0);
  const bool southeast = at.triangle == LandTriangle::kSoutheast;
  const double major = std::max(u, v), minor = std::min(u, v);
  out.barycentric = {1 - major, major - minor, minor};
  const double east_rise = southeast ? double(south[1]) - south[0] : double(north[1]) - north[0];
  const double north_rise = southeast ? double(north[1]) - south[1] : double(north[0]) - south[0];
  out.normal = normalized(Vec<Enu>{-east_rise, -north_rise, grid.spacing_m});
  return out;
}

}  // namespace

struct HeightField::Walked {
  std::optional<Crossing> crossing;
  bool met = false, below = false, at_edge = false;  // below: the ray began below the land
  double begin = 0, end = 0;                         // of the ray within the map
};

HeightField::Walked HeightField::walk(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                                      double bend_per_m) const {
  IRSIG_CHECK(std::isfinite(dot(origin_m, origin_m)));
  IRSIG_CHECK(std::isfinite(dot(direction, direction)));
  HeightWalk ray(tiles_->outer, origin_m, direction, bend_per_m);
  most = std::min(most, kMostDistance);
  Walked out;
  out.end = most;
  if (!ray.clip(out.begin, out.end)) return out;
  const bool from_outside = out.begin > 0;
  const double begin_z_m =
      origin_m.z - bend_per_m * (origin_m.x * origin_m.x + origin_m.y * origin_m.y);
  out.below = !from_outside && begin_z_m < tiles_->z_m(origin_m.x, origin_m.y);
  out.crossing = ray.first_crossing(out.begin, out.end, out.below ? -1 : 1, tiles_->replaced(),
                                    !from_outside && !out.below);
  out.at_edge =
      out.crossing ? from_outside && out.crossing->t == out.begin : out.below && out.end < most;
  out.met = out.at_edge || out.crossing.has_value();
  return out;
}

std::optional<LandHit> HeightField::first_hit(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                                              double bend_per_m) const {
  const Walked ray = walk(origin_m, direction, most, bend_per_m);
  if (!ray.met) return std::nullopt;
  if (ray.at_edge)
    return LandHit{
        .distance = ray.crossing ? ray.begin : ray.end, .from_below = ray.below, .at_edge = true};
  LandHit out = described(ray.crossing->inset ? *tiles_->finer : tiles_->outer, *ray.crossing,
                          origin_m + ray.crossing->t * direction);
  out.from_below = ray.below;
  return out;
}

bool HeightField::hidden(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                         double bend_per_m) const {
  const Walked ray = walk(origin_m, direction, most, bend_per_m);
  return ray.met || ray.below;
}

double HeightField::highest_m(double west_m, double east_m, double south_m, double north_m) const {
  const HeightGrid& grid = tiles_->outer.grid();
  const auto cell = [&](double from_m, int most) {
    return static_cast<int>(std::clamp(std::floor(from_m / grid.spacing_m), -1.0, most + 1.0));
  };
  const int columns = tiles_->outer.columns(), rows = tiles_->outer.rows();
  return static_cast<double>(tiles_->outer.highest_m(
      {cell(west_m - grid.west_m, columns), cell(east_m - grid.west_m, columns) + 1,
       cell(south_m - grid.south_m, rows), cell(north_m - grid.south_m, rows) + 1}));
}

Vec<Enu> HeightField::departure_m(Vec<Enu> origin_m, Vec<Enu> direction, const LandHit& hit) const {
  IRSIG_CHECK(!hit.at_edge);
  Vec<Enu> out = origin_m + hit.distance * direction;
  out.z = tiles_->z_m(out.x, out.y) + (hit.from_below ? -kDepartureM : kDepartureM);
  return out;
}

}  // namespace irsig
