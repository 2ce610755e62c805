#include "core/transport/visible_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/base/work_counts.h"

namespace irsig {
namespace {

constexpr double kCrack = 1e-7, kInFront = 1e-5;  // of the target's size
constexpr double kMargin = 1e-3;                  // of a cell: what touches it
constexpr std::size_t kMostFacets = 256, kMostPieces = 128;

struct Point {
  double x, y;
};

// A triangle on the image plane: its edges as lines whose positive side is inside, and 1 / depth,
// which is linear on the plane.
struct Projected {
  std::array<Point, 3> corner;
  std::array<Point, 3> inward;  // unit normals of the edges
  std::array<double, 3> inverse_depth;
  double x_min, x_max, y_min, y_max, nearest, farthest;
  double at0, per_x, per_y;  // 1 / depth = at0 + per_x x + per_y y
  bool edge_on;

  // Distance inside of an edge.
  [[nodiscard]] double inside(int edge, Point p) const {
    const auto e = static_cast<std::size_t>(edge);
    return inward[e].x * (p.x - corner[e].x) + inward[e].y * (p.y - corner[e].y);
  }
};

Projected project(const Target& target, const PlaneVertices& plane, std::uint32_t facet) {
  Projected out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = target.triangle[3 * static_cast<std::size_t>(facet) + k];
    out.corner[k] = {plane.x_m[v], plane.y_m[v]};
    out.inverse_depth[k] = 1 / plane.depth_m[v];
  }
  const auto& [a, b, c] = out.corner;
  out.x_min = std::min({a.x, b.x, c.x});
  out.x_max = std::max({a.x, b.x, c.x});
  out.y_min = std::min({a.y, b.y, c.y});
  out.y_max = std::max({a.y, b.y, c.y});
  out.nearest = *std::max_element(out.inverse_depth.begin(), out.inverse_depth.end());
  out.farthest = *std::min_element(out.inverse_depth.begin(), out.inverse_depth.end());
  const double twice_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const double longest = std::max(out.x_max - out.x_min, out.y_max - out.y_min);
  out.edge_on = !(std::abs(twice_area) > 1e-12 * longest * longest);
  if (out.edge_on) return out;
  const double sign = twice_area < 0 ? -1 : 1;
  for (std::size_t e = 0; e < 3; ++e) {
    const Point& p = out.corner[e];
    const Point& q = out.corner[(e + 1) % 3];
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    out.inward[e] = {sign * (p.y - q.y) / length, sign * (q.x - p.x) / length};
  }
  const auto& w = out.inverse_depth;
  out.per_x = ((w[1] - w[0]) * (c.y - a.y) - (w[2] - w[0]) * (b.y - a.y)) / twice_area;
  out.per_y = ((w[2] - w[0]) * (b.x - a.x) - (w[1] - w[0]) * (c.x - a.x)) / twice_area;
  out.at0 = w[0] - out.per_x * a.x - out.per_y * a.y;
  return out;
}

// The largest and smallest 1 / depth of what a triangle may have in a rectangle.
struct DepthRange {
  double nearest, farthest;
};
DepthRange range_in(const Projected& t, const std::array<Point, 4>& cell) {
  if (t.edge_on) return {t.nearest, t.farthest};
  DepthRange out{-1e300, 1e300};
  for (const Point& p : cell) {
    const double w = t.at0 + t.per_x * p.x + t.per_y * p.y;
    out.nearest = std::max(out.nearest, w);
    out.farthest = std::min(out.farthest, w);
  }
  return {std::min(out.nearest, t.nearest), std::max(out.farthest, t.farthest)};
}

// Calls visit(index of cell, its corners) for each cell that a triangle touches.
template <typename Visit>
void for_each_touched(const CellGrid& grid, const Projected& t, Visit&& visit) {
  const double x_margin = kMargin * grid.cell_x_m, y_margin = kMargin * grid.cell_y_m;
  const auto range = [](double low, double high, double start, double cell, int count) {
    const double first = std::floor((low - start) / cell), last = std::floor((high - start) / cell);
    return std::array{static_cast<int>(std::clamp(first, 0.0, static_cast<double>(count))),
                      static_cast<int>(std::clamp(last, -1.0, count - 1.0))};
  };
  const auto [first, last] =
      range(t.x_min - x_margin, t.x_max + x_margin, grid.x0_m, grid.cell_x_m, grid.columns);
  const auto [bottom, top] =
      range(t.y_min - y_margin, t.y_max + y_margin, grid.y0_m, grid.cell_y_m, grid.rows);
  const double margin = std::max(x_margin, y_margin);
  for (int column = first; column <= last; ++column)
    for (int row = bottom; row <= top; ++row) {
      const double x = grid.x0_m + column * grid.cell_x_m, y = grid.y0_m + row * grid.cell_y_m;
      const std::array<Point, 4> cell = {Point{x, y}, Point{x + grid.cell_x_m, y},
                                         Point{x + grid.cell_x_m, y + grid.cell_y_m},
                                         Point{x, y + grid.cell_y_m}};
      bool outside = false;
      for (int e = 0; e < 3 && !t.edge_on && !outside; ++e)
        outside = std::all_of(cell.begin(), cell.end(),
                              [&](Point p) { return t.inside(e, p) < -margin; });
      if (!outside) visit(static_cast<std::size_t>(column * grid.rows + row), cell);
    }
}

using Piece = std::vector<Point>;

// Cuts a convex piece along an edge (grown outwards) into the part beyond it and the part within
// it.
void cut(const Piece& piece, const Projected& t, int edge, double grown, Piece& beyond,
         Piece& within) {
  beyond.clear();
  within.clear();
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Point &p = piece[i], &q = piece[(i + 1) % piece.size()];
    const double at_p = t.inside(edge, p) + grown, at_q = t.inside(edge, q) + grown;
    (at_p < 0 ? beyond : within).push_back(p);
    if ((at_p < 0) == (at_q < 0)) continue;
    const double s = at_p / (at_p - at_q);
    const Point crossing{p.x + s * (q.x - p.x), p.y + s * (q.y - p.y)};
    beyond.push_back(crossing);
    within.push_back(crossing);
  }
}

// Returns true if the triangles, all nearer than the hidden facet, cover the cell together.
bool covered(const std::array<Point, 4>& cell, std::span<const Projected* const> facets,
             double grown) {
  std::vector<Piece> left = {Piece(cell.begin(), cell.end())}, next;
  Piece beyond, within;
  for (const Projected* t : facets) {
    next.clear();
    for (Piece& piece : left) {
      bool apart = false;
      for (int e = 0; e < 3 && !apart; ++e)
        apart = std::all_of(piece.begin(), piece.end(),
                            [&](Point p) { return t->inside(e, p) + grown < 0; });
      if (apart) {
        next.push_back(std::move(piece));
        continue;
      }
      for (int e = 0; e < 3 && !piece.empty(); ++e) {
        cut(piece, *t, e, grown, beyond, within);
        if (beyond.size() > 2) next.push_back(beyond);
        piece.swap(within);
        if (piece.size() < 3) piece.clear();
      }
    }
    left.swap(next);
    if (left.empty()) return true;
    if (left.size() > kMostPieces) return false;
  }
  return false;
}

// Takes away the cells in which nothing of `own` can be seen.
void hide(CellGrid& grid, std::span<const Projected> own, std::span<const Projected> all,
          double size_m) {
  std::vector<double> nearest(grid.hit.size(), 0.0);
  for (const Projected& t : own)
    for_each_touched(grid, t, [&](std::size_t i, const std::array<Point, 4>& cell) {
      nearest[i] = std::max(nearest[i], range_in(t, cell).nearest);
    });
  // Inverse distance that a nearer facet must exceed.
  for (double& w : nearest)
    if (w > 0) {
      const double depth_m = 1 / w - kInFront * size_m;
      w = depth_m > 0 ? 1 / depth_m : 1e300;
    }
  const double grown = kCrack * size_m;
  std::vector<std::vector<const Projected*>> over(grid.hit.size());
  for (const Projected& t : all) {
    if (t.edge_on) continue;
    for_each_touched(grid, t, [&](std::size_t i, const std::array<Point, 4>& cell) {
      if (grid.hit[i] == 0 || over[i].size() > kMostFacets) return;
      if (!(range_in(t, cell).farthest > nearest[i])) return;
      bool whole = true;
      for (int e = 0; e < 3 && whole; ++e)
        whole = std::all_of(cell.begin(), cell.end(),
                            [&](Point p) { return t.inside(e, p) + grown >= 0; });
      if (whole)
        grid.hit[i] = 0;
      else
        over[i].push_back(&t);
    });
  }
  for (int column = 0; column < grid.columns; ++column)
    for (int row = 0; row < grid.rows; ++row) {
      const auto i = static_cast<std::size_t>(column * grid.rows + row);
      if (grid.hit[i] == 0 || over[i].empty() || over[i].size() > kMostFacets) continue;
      const double x = grid.x0_m + column * grid.cell_x_m, y = grid.y0_m + row * grid.cell_y_m;
      const std::array<Point, 4> cell = {Point{x, y}, Point{x + grid.cell_x_m, y},
                                         Point{x + grid.cell_x_m, y + grid.cell_y_m},
                                         Point{x, y + grid.cell_y_m}};
      if (covered(cell, over[i], grown)) grid.hit[i] = 0;
    }
}

// The cells of a rectangle that triangles touch.
CellGrid touched(double x0_m, double y0_m, double width_m, double height_m, int cells,
                 std::span<const Projected> own) {
  CellGrid grid;
  const double longest = std::max(width_m, height_m);
  const auto count = [&](double side) {
    return std::clamp(static_cast<int>(std::ceil(side / longest * cells)), 1, cells);
  };
  grid.columns = count(width_m);
  grid.rows = count(height_m);
  grid.x0_m = x0_m;
  grid.y0_m = y0_m;
  grid.cell_x_m = width_m / grid.columns;
  grid.cell_y_m = height_m / grid.rows;
  grid.hit.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0);
  for (const Projected& t : own)
    for_each_touched(grid, t, [&](std::size_t i, const std::array<Point, 4>&) { grid.hit[i] = 1; });
  return grid;
}

}  // namespace

double CellGrid::area_m2() const {
  return cell_x_m * cell_y_m *
         static_cast<double>(std::accumulate(hit.begin(), hit.end(), std::uint64_t{0}));
}

CellGrid visible_cells(const Target& target, const PlaneVertices& plane,
                       std::span<const std::uint32_t> facets, double size_m, int cells) {
  std::vector<Projected> own, all;
  double x_min = 1e300, x_max = -1e300, y_min = 1e300, y_max = -1e300;
  for (const std::uint32_t f : facets) {
    const Projected& t = own.emplace_back(project(target, plane, f));
    x_min = std::min(x_min, t.x_min);
    x_max = std::max(x_max, t.x_max);
    y_min = std::min(y_min, t.y_min);
    y_max = std::max(y_max, t.y_max);
  }
  count_work(Work::kFacetsProjected, target.facet.size());
  for (std::uint32_t f = 0; f < target.facet.size(); ++f) {
    Projected t = project(target, plane, f);
    if (t.x_max >= x_min && t.x_min <= x_max && t.y_max >= y_min && t.y_min <= y_max && !t.edge_on)
      all.push_back(t);
  }
  // Sides as short as rays are rounded get a rim that holds the rounding.
  const double thin = 1.0 / 256 * size_m, rounding = 5e-7 * size_m;
  const auto widen = [&](double& low, double& high) {
    if (high - low > thin) return;
    low -= rounding;
    high += rounding;
  };
  widen(x_min, x_max);
  widen(y_min, y_max);
  CellGrid grid;
  for (int cuts = 0; cuts < 8; ++cuts) {
    grid = touched(x_min, y_min, x_max - x_min, y_max - y_min, cells, own);
    hide(grid, own, all, size_m);
    int first = grid.columns, last = -1, bottom = grid.rows, top = -1;
    for (int column = 0; column < grid.columns; ++column)
      for (int row = 0; row < grid.rows; ++row) {
        if (grid.hit[static_cast<std::size_t>(column * grid.rows + row)] == 0) continue;
        first = std::min(first, column);
        last = std::max(last, column);
        bottom = std::min(bottom, row);
        top = std::max(top, row);
      }
    const double share = static_cast<double>(last - first + 1) * (top - bottom + 1) /
                         (static_cast<double>(grid.columns) * grid.rows);
    if (last < 0 || share > 0.5) break;
    const double x0 = grid.x0_m, y0 = grid.y0_m;
    x_min = x0 + first * grid.cell_x_m;
    x_max = x0 + (last + 1) * grid.cell_x_m;
    y_min = y0 + bottom * grid.cell_y_m;
    y_max = y0 + (top + 1) * grid.cell_y_m;
    // Rays cannot be aimed at a smaller rectangle.
    if (x_max - x_min < 1e-4 * size_m || y_max - y_min < 1e-4 * size_m) break;
  }
  return grid;
}

}  // namespace irsig
