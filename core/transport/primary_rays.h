#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/sobol.h"
#include "core/geo/viewpoint.h"
#include "core/scene/trace/target.h"
#include "core/transport/visible_cells.h"

namespace irsig {

// On a view's image plane; to the right and up from where its axis meets it.
struct PlaneRectangle {
  double x0_m = 0, y0_m = 0, width_m = 0, height_m = 0;
};

// The sensor's view of a target: a pinhole at the viewpoint, an image plane through the target's
// bounding sphere, and where on that plane a stratum of the target can be seen at all.
struct ViewFrame : PlaneRectangle {  // the target's bounding rectangle
  Vec<Body> sensor;                  // relative to the target's centre
  Vec<Body> forward, right, up;      // unit vectors; up is the direction of growing elevation
  double plane_m = 0;                // distance from the sensor to the image plane
};

// Returns the cells of a rectangle of the image plane that facets touch, conservatively, with
// cells_long_side cells along its longer side.
//   x, y  the vertices' places on the image plane [m]
[[nodiscard]] CellGrid touched_cells(const Target& target, const PlaneRectangle& frame,
                                     const std::vector<double>& x_m, const std::vector<double>& y_m,
                                     std::span<const std::uint32_t> facets,
                                     std::uint32_t cells_long_side);

// Mask at which primary rays of one stratum are aimed: uniformly over the cells of the bounding
// rectangle that its triangles touch (conservatively), so that few rays miss; the density is
// positive wherever the stratum can be seen, as an unbiased estimate requires. The unit square is
// mapped to the cells column by column, which keeps the stratification of the sampler.
class CoverageMask {
 public:
  // x, y: the vertices' places on the image plane [m]; facets: the stratum's triangles.
  CoverageMask(const Target& target, const ViewFrame& frame, const std::vector<double>& x_m,
               const std::vector<double>& y_m, std::span<const std::uint32_t> facets,
               std::uint32_t cells_long_side);

  // Covers the cells of a grid that are hit.
  explicit CoverageMask(const CellGrid& grid);

  // Covers the whole rectangle of the frame.
  static CoverageMask whole(const ViewFrame& frame);

  [[nodiscard]] bool empty() const { return occupied_ == 0; }
  // Returns the covered area on the image plane [m2]: the inverse of the sampling density.
  [[nodiscard]] double area_m2() const { return area_m2_; }

  struct Point {
    float x_m, y_m;
  };
  [[nodiscard]] Point map(SamplePair s) const {
    const float position = std::min(s.x * static_cast<float>(occupied_), largest_position_);
    std::uint32_t column =
        guide_[static_cast<std::uint32_t>(s.x * static_cast<float>(guide_.size()))];
    while (position >= column_end_[column]) ++column;
    const float begin = column == 0 ? 0.0f : column_end_[column - 1];
    const float count = column_end_[column] - begin;
    const float within = (position - begin) / count;
    const float t = s.y * count;
    auto k = static_cast<std::uint32_t>(t);
    if (k >= static_cast<std::uint32_t>(count)) k = static_cast<std::uint32_t>(count) - 1;
    const auto row = static_cast<float>(row_[static_cast<std::uint32_t>(begin) + k]);
    return {x0_ + (static_cast<float>(column) + within) * cell_x_,
            y0_ + (row + (t - static_cast<float>(k))) * cell_y_};
  }

 private:
  CoverageMask() = default;
  void make_guide();

  std::uint32_t occupied_ = 0;
  double area_m2_ = 0;
  float largest_position_ = 0;  // just below occupied_
  float x0_ = 0, y0_ = 0, cell_x_ = 0, cell_y_ = 0;
  std::vector<float> column_end_;     // running count of occupied cells (exact: fewer than 2^24)
  std::vector<std::uint16_t> row_;    // rows of the occupied cells, by column
  std::vector<std::uint16_t> guide_;  // a column at or before the one of s.x
};

// Primary rays that are denser where more is to be seen: over the cells of a grid that are hit,
// with a density in proportion to a weight. Stratified as the sampler's points are.
class CellDensity {
 public:
  // weight: [cell], positive where the cell is hit
  CellDensity(const CellGrid& grid, std::span<const double> weight);

  struct Place {
    float x_m, y_m;
    float factor;  // the density of CoverageMask(grid) over that here
  };
  [[nodiscard]] Place map(SamplePair s) const;

 private:
  double x0_m_, y0_m_, cell_x_m_, cell_y_m_;
  int rows_;
  std::vector<double> column_end_;  // running share of the columns
  std::vector<double> cell_end_;    // [cell] of a column's cells, its own share 1
  std::vector<float> factor_;       // [cell]
};

// Small facets of a target that may be bright and get rays of their own: facets in groups that lie
// close together (none of a hot part, which gets rays of its own anyway).
struct BrightFacets {
  std::vector<std::vector<std::uint32_t>> group;
  bool past_others = false;  // hot parts and groups are looked for past what hides them
  // [stratum] Samples of each, relative to the number that is asked for; empty: as where nothing is
  // bright, and of each group all.
  std::vector<double> share;
  bool operator==(const BrightFacets&) const = default;
  [[nodiscard]] bool none() const { return group.empty() && !past_others; }
};

// Largest number of samples of one stratum in each replicate: the sampler's coordinates have 23
// bits.
inline constexpr std::uint64_t kMostOfStratum = std::uint64_t{1} << 23;

// A view with the masks of its strata: everything that is neither hot nor bright, then one stratum
// for each hot part, then one for each group of bright facets.
struct AimedView {
  double range_m = 0;
  ViewFrame frame;
  std::vector<std::uint32_t> stratum_of_part;
  std::vector<CoverageMask> stratum;
  std::vector<std::uint32_t> stratum_of_facet;  // empty: that of its part
  std::uint32_t first_bright = 0;               // stratum; 0: no facets are bright
  BrightFacets bright;                          // for which it was made
  std::optional<CellDensity> density;           // of stratum 0, instead of a uniform one

  [[nodiscard]] std::uint32_t stratum_of(std::uint32_t facet, std::uint32_t part) const {
    return stratum_of_facet.empty() ? stratum_of_part[part] : stratum_of_facet[facet];
  }
  // Returns the samples of a stratum in each replicate: all of them for the main stratum (0) and
  // for bright facets; an eighth for a hot part, which is small and bright, whatever its area.
  [[nodiscard]] std::uint64_t samples(std::uint32_t of_stratum, std::uint64_t samples) const {
    if (!bright.share.empty())
      return std::clamp<std::uint64_t>(
          static_cast<std::uint64_t>(bright.share[of_stratum] * static_cast<double>(samples)), 16,
          kMostOfStratum);
    if (of_stratum == 0 || (first_bright > 0 && of_stratum >= first_bright)) return samples;
    return std::max<std::uint64_t>(64, samples / 8);
  }
};

// Returns the view with one stratum, the whole rectangle of its frame: every primary ray counts for
// what it meets, hot and bright facets included.
[[nodiscard]] AimedView whole_view(const AimedView& view);
// Checks that the sensor stands outside. INVALID_ARGUMENT: the sensor is inside the target's convex
// hull, or within a hundredth of the target's radius of it. A sensor that is nearer than the target
// reaches looks past the reference point, so that all of the target is in front of it.
[[nodiscard]] absl::Status check_outside(const Target& target, const Viewpoint& viewpoint);
// Returns the frame of a sensor that looks at the target. Its rectangle is still to be stated.
[[nodiscard]] ViewFrame make_view_frame(const Target& target, const Viewpoint& viewpoint);
// Returns the view of a sensor outside the target.
[[nodiscard]] AimedView make_aimed_view(const Target& target, const Viewpoint& viewpoint,
                                        const BrightFacets& bright = {});

// A narrow view: all that is seen of a sensor (body frame) through a rectangle of width x height
// across the line of sight at the point `at` (body frame), the target or what is behind it. One
// stratum.
struct FootprintView {
  AimedView view;
  double footprint_m2 = 0;  // range^2 x solid angle: weights / footprint_m2 give mean radiances
};
[[nodiscard]] FootprintView make_footprint_view(const Target& target, Vec<Body> sensor,
                                                Vec<Body> at, double width_m, double height_m);

}  // namespace irsig
