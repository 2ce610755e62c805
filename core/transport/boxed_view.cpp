#include "core/transport/boxed_view.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"

namespace irsig {
namespace {

constexpr int kCells = 256;           // along the longer side
constexpr double kCellMargin = 1e-3;  // of a cell: far above rounding
// Shares of the rays: evenly, by what is seen where nothing absorbs, the rest by what is seen at
// the other optical depths.
constexpr double kEven = 0.2, kOfThin = 0.4;
constexpr std::size_t kDepths = SightShares::kOpticalDepth.size();
// Rays that are expected and do not come: chance exp(-3).
constexpr double kRaysMissed = 3;

using Seen = std::array<std::array<std::vector<double>, 2>, kDepths>;

struct Rectangle {
  double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
  void add(const Rectangle& r) {
    x0 = std::min(x0, r.x0);
    y0 = std::min(y0, r.y0);
    x1 = std::max(x1, r.x1);
    y1 = std::max(y1, r.y1);
  }
};

// Cells of a grid that a rectangle of the image plane touches.
struct CellRange {
  int column0, column1, row0, row1;
  CellRange(const CellGrid& grid, const Rectangle& r) {
    const auto cell = [](double x, double size, int count) {
      return std::clamp(static_cast<int>(std::floor(x / size)), 0, count - 1);
    };
    column0 = cell(r.x0 - grid.x0_m, grid.cell_x_m, grid.columns);
    column1 = cell(r.x1 - grid.x0_m, grid.cell_x_m, grid.columns);
    row0 = cell(r.y0 - grid.y0_m, grid.cell_y_m, grid.rows);
    row1 = cell(r.y1 - grid.y0_m, grid.cell_y_m, grid.rows);
  }
  [[nodiscard]] double count() const { return (column1 - column0 + 1.0) * (row1 - row0 + 1.0); }
  template <typename Visit>
  void for_each(const CellGrid& grid, Visit visit) const {
    for (int c = column0; c <= column1; ++c)
      for (int r = row0; r <= row1; ++r)
        visit(static_cast<std::size_t>(c) * static_cast<std::size_t>(grid.rows) +
              static_cast<std::size_t>(r));
  }
};

// A point as the sensor sees it.
struct SeenPoint {
  double distance_m, amount_m2;  // along the line of sight; by cell, over the cell's area there
  std::array<double, 2> sends;   // by cell
  CellRange cells;
};

// Shares of each measure by cell; all 0 where a measure has nothing. One pass from near to far for
// each optical depth.
Seen find_seen(const CellGrid& grid, std::vector<SeenPoint> point) {
  std::sort(point.begin(), point.end(),
            [](const SeenPoint& a, const SeenPoint& b) { return a.distance_m < b.distance_m; });
  std::vector<double> column(grid.hit.size(), 0.0);
  for (const SeenPoint& p : point)
    p.cells.for_each(grid, [&](std::size_t cell) { column[cell] += p.amount_m2; });
  const double most = *std::max_element(column.begin(), column.end());
  Seen out;
  for (std::size_t d = 0; d < kDepths; ++d) {
    const double absorbs = most > 0 ? SightShares::kOpticalDepth[d] / most : 0;
    std::vector<double> through(grid.hit.size(), 1.0);
    for (std::vector<double>& seen : out[d]) seen.assign(grid.hit.size(), 0.0);
    for (const SeenPoint& p : point) {
      const double depth = absorbs * p.amount_m2, left = std::exp(-depth),
                   own = depth > 0 ? -std::expm1(-depth) / depth : 1;
      p.cells.for_each(grid, [&](std::size_t cell) {
        for (std::size_t m = 0; m < 2; ++m) out[d][m][cell] += through[cell] * own * p.sends[m];
        through[cell] *= left;
      });
    }
    for (std::vector<double>& seen : out[d]) {
      const double sum = std::accumulate(seen.begin(), seen.end(), 0.0);
      if (sum > 0)
        for (double& share : seen) share /= sum;
    }
  }
  return out;
}

}  // namespace

SightShares::SightShares(Seen seen, std::vector<double> of_rays)
    : seen_(std::move(seen)), of_rays_(std::move(of_rays)) {}

double SightShares::missed(std::size_t depth, std::size_t measure, double rays) const {
  struct Bright {
    double ratio, share, rays;
    bool operator<(const Bright& other) const { return ratio < other.ratio; }
  };
  std::vector<Bright> cells;
  const std::vector<double>& seen = seen_[depth][measure];
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i] > 0) cells.push_back({seen[i] / of_rays_[i], seen[i], rays * of_rays_[i]});
  std::make_heap(cells.begin(), cells.end());
  double expected = 0, missed = 0;
  while (!cells.empty()) {
    const Bright& top = cells.front();
    if (expected + top.rays > kRaysMissed) return missed - expected * top.ratio / rays;
    expected += top.rays;
    missed += top.share;
    std::pop_heap(cells.begin(), cells.end());
    cells.pop_back();
  }
  return missed;
}

absl::StatusOr<BoxedView> make_boxed_view(const Target& target, const Viewpoint& viewpoint,
                                          const BoxedSight& sight) {
  AimedView view;
  view.range_m = viewpoint.range_m;
  ViewFrame& frame = view.frame = make_view_frame(target, viewpoint);
  const auto from_sensor = [&](Vec<Body> at) { return at - target.centre - frame.sensor; };
  double nearest_m = 1e300;
  for (const auto& box : sight.box)
    for (const Vec<Body>& corner : box)
      nearest_m = std::min(nearest_m, 0.999 * dot(from_sensor(corner), frame.forward));
  if (!(nearest_m > 0.01 * viewpoint.range_m))
    return keyed_problem("viewpoints.range_m",
                         absl::StrCat("hot gas reaches to the sensor at ", viewpoint.range_m,
                                      " m, azimuth ", viewpoint.aspect_azimuth_deg, ", elevation ",
                                      viewpoint.aspect_elevation_deg, " deg, or behind it"));
  frame.plane_m = std::min(frame.plane_m, nearest_m);
  // A place on the image plane, and what is `reach_m` around it.
  const auto on_plane = [&](Vec<Body> at, double reach_m) {
    const Vec<Body> q = from_sensor(at);
    const double scale = frame.plane_m / dot(q, frame.forward), x = scale * dot(q, frame.right),
                 y = scale * dot(q, frame.up), reach = scale * reach_m;
    return Rectangle{x - reach, y - reach, x + reach, y + reach};
  };
  std::vector<Rectangle> of_box;
  Rectangle all;
  for (const auto& box : sight.box) {
    Rectangle& r = of_box.emplace_back();
    for (const Vec<Body>& corner : box) r.add(on_plane(corner, 0));
    all.add(r);
  }
  view.stratum_of_part.assign(target.part.size(), 0);
  frame.x0_m = all.x0;
  frame.y0_m = all.y0;
  frame.width_m = all.x1 - all.x0;
  frame.height_m = all.y1 - all.y0;
  const double cell_m = std::max(frame.width_m, frame.height_m) / kCells;
  const auto cells = [&](double side_m) {
    return std::clamp(static_cast<int>(std::ceil(side_m / cell_m)), 1, kCells);
  };
  CellGrid grid{frame.x0_m, frame.y0_m, 0, 0, cells(frame.width_m), cells(frame.height_m), {}};
  grid.cell_x_m = frame.width_m / grid.columns;
  grid.cell_y_m = frame.height_m / grid.rows;
  grid.hit.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0);
  const double margin_m = kCellMargin * cell_m;
  for (const Rectangle& r : of_box)
    CellRange(grid, {r.x0 - margin_m, r.y0 - margin_m, r.x1 + margin_m, r.y1 + margin_m})
        .for_each(grid, [&](std::size_t cell) { grid.hit[cell] = 1; });
  view.stratum.emplace_back(grid);

  std::vector<SeenPoint> points;
  for (const BoxedSight::Point& point : sight.point) {
    const CellRange range(grid, on_plane(point.at, point.reach_m));
    const double distance_m = dot(from_sensor(point.at), frame.forward),
                 scale = distance_m / frame.plane_m,
                 area_m2 = scale * scale * grid.cell_x_m * grid.cell_y_m, count = range.count();
    points.push_back({distance_m,
                      point.amount / (count * area_m2),
                      {point.sends[0] / count, point.sends[1] / count},
                      range});
  }
  Seen seen = find_seen(grid, std::move(points));
  const auto hit = static_cast<double>(std::count(grid.hit.begin(), grid.hit.end(), 1));
  std::vector<double> weight(grid.hit.size());
  double sum = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    if (grid.hit[i] == 0) {
      for (auto& of_depth : seen)
        for (std::vector<double>& share : of_depth) share[i] = 0;
      continue;
    }
    weight[i] = kEven / hit;
    for (std::size_t d = 0; d < kDepths; ++d)
      for (const std::vector<double>& share : seen[d])
        weight[i] += 0.5 * (d == 0 ? kOfThin : (1 - kEven - kOfThin) / (kDepths - 1)) * share[i];
    sum += weight[i];
  }
  view.density.emplace(grid, weight);
  for (double& w : weight) w /= sum;
  return BoxedView{std::move(view), SightShares(std::move(seen), std::move(weight))};
}

}  // namespace irsig
