#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"

namespace irsig {

// Most vertices of a grid: their heights and bounds take 1.2 GB.
inline constexpr std::uint64_t kMostLandVertices = 1ULL << 28;

// A regular grid of vertices in the local frame of the land's origin. Vertex (column, row) lies at
// x = west_m + column spacing_m, y = south_m + row spacing_m, z = z_m[row (columns + 1) + column].
// The curvature of the Earth is part of z.
struct HeightGrid {
  double west_m = 0, south_m = 0;       // x and y of vertex (0, 0)
  double spacing_m = 0;                 // of vertices, along x and along y
  std::uint32_t columns = 0, rows = 0;  // numbers of cells: one less than vertices
  std::vector<float> z_m;  // (columns + 1) (rows + 1) heights, row by row from the south
};

// The diagonal of each cell runs from its southwest to its northeast corner.
enum class LandTriangle : std::uint8_t {
  kSoutheast,  // corners southwest, southeast, northeast
  kNorthwest,  // corners southwest, northwest, northeast
};

struct LandHit {
  double distance = 0;  // along the ray, in lengths of its direction
  bool inset = false;   // column and row count cells of the inset
  std::uint32_t column = 0, row = 0;
  LandTriangle triangle = LandTriangle::kSoutheast;
  std::array<double, 3> barycentric{};  // weights of the triangle's corners, in the order above
  Vec<Enu> normal{};                    // of the triangle, of length 1, upwards
  bool from_below = false;              // the ray began below the land
  bool at_edge = false;  // the vertical wall at the map's edge, whose normal is not given
};

// Land as a solid body below a surface of triangles, bounded by vertical walls at the edge of its
// map and without a bottom. An inset replaces whole cells of the outer grid by finer ones.
//
// A ray is followed from cell to cell with the side of the surface that it began on. The first
// point on the other side is its hit, in the cell or on the edge where it is found. So no ray is
// lost at a vertex, an edge, or the seam of the inset, and no ray that begins below the land leaves
// it. Blocks of 4^n x 4^n cells are skipped if the ray stays above their highest vertex.
//
// Accuracy: hits differ from those of exact arithmetic on the same vertices for rays alone that
// pass the surface within 1e-9 m. The seam of an inset adds the rounding of its vertices to
// float32: 2e-6 m at heights of 20 m, 6e-5 m at 1000 m (tests/unit/height_field_test.cpp).
// Memory: 4.8 bytes a cell. Immutable; may be used by several threads at once.
class HeightField {
 public:
  // Makes a height field. The outermost vertices of the inset move onto the edges of the outer
  // cells around it. INVALID_ARGUMENT: a size of 0, more than kMostLandVertices, heights that are
  // not finite or of another number, an inset that is not aligned with the cells of the outer grid.
  [[nodiscard]] static absl::StatusOr<HeightField> create(
      HeightGrid outer, std::optional<HeightGrid> inset = std::nullopt);
  HeightField(HeightField&&) noexcept;
  HeightField& operator=(HeightField&&) noexcept;
  ~HeightField();

  // Returns the first point of the ray origin + distance direction, 0 <= distance <= most, on the
  // land's surface or on the wall at its edge. A ray that touches the surface without passing it
  // has no hit. Finite numbers, |direction| > 0; most: at most 1e9, larger values count as that.
  //   bend_per_m  of all rays of the frame: each point of a ray, its origin too, lies lower than
  //               that of the straight one by bend_per_m (x^2 + y^2). Within a cell of s m a bent
  //               ray is taken as straight, which misplaces it by |bend_per_m| s^2 / 2 (6e-6 m for
  //               30 m).
  [[nodiscard]] std::optional<LandHit> first_hit(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                                                 double bend_per_m = 0) const;

  // Returns true if the land covers the segment: its origin is below the surface, or it has a hit.
  [[nodiscard]] bool hidden(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                            double bend_per_m = 0) const;

  // Returns the surface's height z at (x, y), or nothing beyond the map's edge.
  [[nodiscard]] std::optional<double> z_m(double x_m, double y_m) const;

  // Returns an upper bound of the surface's heights z within a rectangle; -infinity: it holds no
  // part of the map.
  [[nodiscard]] double highest_m(double west_m, double east_m, double south_m,
                                 double north_m) const;

  // Returns a point 1 um above the surface at (x, y) (below it for a hit from below), where a ray
  // may begin that must not meet the surface at its own origin. Requires a hit that is not at_edge.
  [[nodiscard]] Vec<Enu> departure_m(Vec<Enu> origin_m, Vec<Enu> direction,
                                     const LandHit& hit) const;

  [[nodiscard]] const HeightGrid& outer() const;
  [[nodiscard]] const HeightGrid* inset() const;  // null: there is none
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Tiles;
  struct Walked;
  [[nodiscard]] Walked walk(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                            double bend_per_m) const;
  explicit HeightField(std::unique_ptr<const Tiles> tiles);
  std::unique_ptr<const Tiles> tiles_;
};

}  // namespace irsig
