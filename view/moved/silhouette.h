#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/environment/background_directions.h"
#include "core/geo/frames.h"
#include "core/geo/viewpoint.h"

namespace irsig {

// The triangles of a target in the body frame [m].
struct TargetShape {
  std::vector<Vec<Body>> vertex;
  std::vector<std::array<std::uint32_t, 3>> triangle;
  std::vector<std::uint32_t> part;  // [triangle]
  std::vector<bool> two_sided;      // [part]
};

// The outline of a target in perspective from one viewpoint, without the parts below the waterline
// (body z > 0) if there is one. Rows of constant height in the sensor's image plane hold the union
// of the facets that face the sensor: exact along a row, sampled across rows. Rows begin and end at
// the horizons and at the vertices of small meshes, so that a box is exact.
class Silhouette {
 public:
  //   horizon_z  z of the directions at which the radiance behind the target jumps
  //   (BackgroundDirections)
  Silhouette(const TargetShape& shape, const Viewpoint& viewpoint, bool waterline,
             std::span<const float> horizon_z);

  // Returns range^2 x solid angle [m2]. area_error_m2() is its difference from the value with half
  // as many rows.
  [[nodiscard]] double area_m2() const { return fine_.area_m2; }
  [[nodiscard]] double area_error_m2() const;
  // Returns the smallest z of the covered directions (unit vectors away from the sensor); most_z()
  // returns the largest.
  [[nodiscard]] double least_z() const { return fine_.least_z; }
  [[nodiscard]] double most_z() const { return fine_.most_z; }

  // The fraction of the silhouette before each node, and by how much half as many rows differ.
  struct Fractions {
    std::vector<double> value, error;
  };
  [[nodiscard]] Fractions before(const BackgroundDirections& nodes) const;

 private:
  struct Piece {
    double z, area_m2;
  };
  struct Rows {
    std::vector<Piece> piece;
    double area_m2 = 0, least_z = 1, most_z = -1;
  };
  Rows fine_, coarse_;
};

// Visible area of each part [m2: range^2 x solid angle] from one viewpoint, by a raster with a
// depth buffer, and its error (one sigma) from the size of the cells.
struct PartAreas {
  std::vector<double> area_m2, error_m2;
};
[[nodiscard]] PartAreas part_areas(const TargetShape& shape, const Viewpoint& viewpoint,
                                   bool waterline);

// Returns for each part the change of its facets relative to each other between two ranges,
// whatever hides them. It is the sum over facets of the change of the area that faces the sensor;
// or, if larger, the largest change by distance alone. The change is relative to the part's area,
// without the change that all facets share. [part]
[[nodiscard]] std::vector<double> facet_changes(const TargetShape& shape, const Viewpoint& from,
                                                double to_range_m, bool waterline);

}  // namespace irsig
