#include "core/transport/primary_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"

namespace irsig {

CellGrid touched_cells(const Target& target, const PlaneRectangle& frame,
                       const std::vector<double>& x_m, const std::vector<double>& y_m,
                       std::span<const std::uint32_t> facets, std::uint32_t cells_long_side) {
  const double longest = std::max(frame.width_m, frame.height_m);
  const auto cells = [&](double side) {
    return std::clamp<int>(static_cast<int>(std::ceil(side / longest * cells_long_side)), 1,
                           static_cast<int>(cells_long_side));
  };
  const int columns = cells(frame.width_m), rows = cells(frame.height_m);
  const double cell_x = frame.width_m / columns, cell_y = frame.height_m / rows;
  CellGrid grid{frame.x0_m, frame.y0_m, cell_x, cell_y, columns, rows, {}};
  std::vector<std::uint8_t>& hit = grid.hit;
  hit.assign(static_cast<std::size_t>(columns * rows), 0);

  // Coordinates in cells, of all vertices at once where most of them are needed.
  struct Place {
    float x, y;
  };
  const auto placed = [&](std::uint32_t v) {
    return Place{static_cast<float>((x_m[v] - frame.x0_m) / cell_x),
                 static_cast<float>((y_m[v] - frame.y0_m) / cell_y)};
  };
  std::vector<Place> known(3 * facets.size() > x_m.size() ? x_m.size() : 0);
  for (std::uint32_t v = 0; v < known.size(); ++v) known[v] = placed(v);
  const auto place = [&](std::uint32_t v) { return known.empty() ? placed(v) : known[v]; };
  // floor() within the grid.
  const auto cell = [](float x, int count) {
    return std::min(static_cast<int>(std::max(x, 0.0f)), count - 1);
  };
  constexpr float kMargin = 2e-3f;  // in cells: far above the rounding of the projection
  for (const std::uint32_t t : facets) {
    const std::uint32_t* corner = target.triangle.data() + 3 * static_cast<std::size_t>(t);
    const auto [ax, ay] = place(corner[0]);
    const auto [bx, by] = place(corner[1]);
    const auto [cx, cy] = place(corner[2]);
    const int first = cell(std::min({ax, bx, cx}) - kMargin, columns);
    const int last = cell(std::max({ax, bx, cx}) + kMargin, columns);
    const int bottom = cell(std::min({ay, by, cy}) - kMargin, rows);
    const int top = cell(std::max({ay, by, cy}) + kMargin, rows);
    if ((last - first + 1) * (top - bottom + 1) <= 4) {
      for (int column = first; column <= last; ++column)
        for (int row = bottom; row <= top; ++row)
          hit[static_cast<std::size_t>(column * rows + row)] = 1;
      continue;
    }
    // Edge functions, oriented so that the triangle's inside is positive; a cell is out if it lies
    // wholly outside one edge.
    const float area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    const float sign = area < 0 ? -1.0f : 1.0f;
    const float ex[3] = {sign * (ay - by), sign * (by - cy), sign * (cy - ay)};
    const float ey[3] = {sign * (bx - ax), sign * (cx - bx), sign * (ax - cx)};
    const float qx[3] = {ax, bx, cx}, qy[3] = {ay, by, cy};
    for (int column = first; column <= last; ++column)
      for (int row = bottom; row <= top; ++row) {
        std::uint8_t& covered = hit[static_cast<std::size_t>(column * rows + row)];
        if (covered != 0) continue;
        bool outside = false;
        for (int e = 0; e < 3; ++e) {
          // The cell's corner (grown by the margin) that lies furthest inside this edge.
          const float x = static_cast<float>(column) + (ex[e] > 0 ? 1 + kMargin : -kMargin);
          const float y = static_cast<float>(row) + (ey[e] > 0 ? 1 + kMargin : -kMargin);
          if (ex[e] * (x - qx[e]) + ey[e] * (y - qy[e]) < 0) outside = true;
        }
        covered = outside ? 0 : 1;
      }
  }
  return grid;
}

CoverageMask::CoverageMask(const Target& target, const ViewFrame& frame,
                           const std::vector<double>& x_m, const std::vector<double>& y_m,
                           std::span<const std::uint32_t> facets, std::uint32_t cells_long_side)
    : CoverageMask(touched_cells(target, frame, x_m, y_m, facets, cells_long_side)) {}

CoverageMask::CoverageMask(const CellGrid& grid) {
  float running = 0;
  for (int column = 0; column < grid.columns; ++column) {
    for (int row = 0; row < grid.rows; ++row)
      if (grid.hit[static_cast<std::size_t>(column * grid.rows + row)] != 0) {
        row_.push_back(static_cast<std::uint16_t>(row));
        running += 1;
      }
    column_end_.push_back(running);
  }
  occupied_ = static_cast<std::uint32_t>(row_.size());
  area_m2_ = occupied_ * grid.cell_x_m * grid.cell_y_m;
  x0_ = static_cast<float>(grid.x0_m);
  y0_ = static_cast<float>(grid.y0_m);
  cell_x_ = static_cast<float>(grid.cell_x_m);
  cell_y_ = static_cast<float>(grid.cell_y_m);
  largest_position_ = std::nextafter(static_cast<float>(occupied_), 0.0f);
  if (occupied_ > 0) make_guide();
}

CoverageMask CoverageMask::whole(const ViewFrame& frame) {
  CoverageMask mask;
  mask.occupied_ = 1;
  mask.area_m2_ = frame.width_m * frame.height_m;
  mask.largest_position_ = std::nextafter(1.0f, 0.0f);
  mask.x0_ = static_cast<float>(frame.x0_m);
  mask.y0_ = static_cast<float>(frame.y0_m);
  mask.cell_x_ = static_cast<float>(frame.width_m);
  mask.cell_y_ = static_cast<float>(frame.height_m);
  mask.column_end_ = {1.0f};
  mask.row_ = {0};
  mask.make_guide();
  return mask;
}

CellDensity::CellDensity(const CellGrid& grid, std::span<const double> weight)
    : x0_m_(grid.x0_m),
      y0_m_(grid.y0_m),
      cell_x_m_(grid.cell_x_m),
      cell_y_m_(grid.cell_y_m),
      rows_(grid.rows) {
  double all = 0, hit = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    all += weight[i];
    hit += grid.hit[i] != 0 ? 1 : 0;
  }
  double running = 0;
  for (int column = 0; column < grid.columns; ++column) {
    const auto first = static_cast<std::size_t>(column) * static_cast<std::size_t>(rows_);
    double of_column = 0;
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows_); ++row)
      of_column += weight[first + row];
    running += of_column;
    column_end_.push_back(running / all);
    double within = 0;
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows_); ++row) {
      const double w = weight[first + row];
      within += w;
      cell_end_.push_back(of_column > 0 ? within / of_column : 0);
      factor_.push_back(w > 0 ? static_cast<float>(all / (w * hit)) : 0.0f);
    }
  }
}

CellDensity::Place CellDensity::map(SamplePair s) const {
  // The first end beyond x; steps of no width are never taken.
  const auto pick = [](auto begin, auto end, double x) {
    const auto at = std::min(std::upper_bound(begin, end, x),
                             std::upper_bound(begin, end, 0.999999 * *(end - 1)));
    const double low = at == begin ? 0 : *(at - 1);
    return std::pair(at - begin, std::clamp((x - low) / (*at - low), 0.0, 1.0));
  };
  const auto [column, across] = pick(column_end_.begin(), column_end_.end(), s.x);
  const auto cells = cell_end_.begin() + column * rows_;
  const auto [row, up] = pick(cells, cells + rows_, s.y);
  return {static_cast<float>(x0_m_ + (static_cast<double>(column) + across) * cell_x_m_),
          static_cast<float>(y0_m_ + (static_cast<double>(row) + up) * cell_y_m_),
          factor_[static_cast<std::size_t>(column * rows_ + row)]};
}

void CoverageMask::make_guide() {
  // guide_[g]: the first column whose end lies beyond g / size.
  constexpr std::size_t kGuide = 1024;
  std::uint16_t column = 0;
  for (std::size_t g = 0; g < kGuide; ++g) {
    const float position = static_cast<float>(g) / kGuide * static_cast<float>(occupied_);
    while (position >= column_end_[column]) ++column;
    guide_.push_back(column);
  }
}

namespace {

// Returns the margin of the rectangle beyond a side of a stratum of a target of this size. It is 0,
// because a rim that no sample happens to meet makes the value too large at a standard error of 0.
// The rounding of rays (rms 5e-8 of the size) then loses 4e-8 size / side at the edges. A side that
// is not much longer than that rounding gets a rim which holds it, and which is wide enough,
// compared with the side, for samples to meet it; edge-on too, the area is positive.
double margin_m(double side_m, double size_m) {
  constexpr double kThin = 1.0 / 256, kRounding = 5e-7;
  return side_m > kThin * size_m ? 0.0 : kRounding * size_m;
}

// The frame with the bounding rectangle of these triangles in place of the target's.
ViewFrame bounds_of(const Target& target, ViewFrame frame, const std::vector<double>& x_m,
                    const std::vector<double>& y_m, std::span<const std::uint32_t> facets) {
  double x_min = 1e300, x_max = -1e300, y_min = 1e300, y_max = -1e300;
  for (const std::uint32_t t : facets)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = target.triangle[3 * static_cast<std::size_t>(t) + k];
      x_min = std::min(x_min, x_m[v]);
      x_max = std::max(x_max, x_m[v]);
      y_min = std::min(y_min, y_m[v]);
      y_max = std::max(y_max, y_m[v]);
    }
  if (x_min > x_max) return frame;  // no triangles: the mask is empty whatever its rectangle
  const double size_m = std::max(frame.width_m, frame.height_m);
  const double x_margin_m = margin_m(x_max - x_min, size_m),
               y_margin_m = margin_m(y_max - y_min, size_m);
  frame.x0_m = x_min - x_margin_m;
  frame.y0_m = y_min - y_margin_m;
  frame.width_m = x_max - x_min + 2 * x_margin_m;
  frame.height_m = y_max - y_min + 2 * y_margin_m;
  return frame;
}

Vec<Body> place_of(const Target& target, std::size_t vertex) {
  return {static_cast<double>(target.vertex[3 * vertex]),
          static_cast<double>(target.vertex[3 * vertex + 1]),
          static_cast<double>(target.vertex[3 * vertex + 2])};
}

constexpr int kMaskCells = 128;

bool reaches_beyond(const Target& target, double range_m) {
  return range_m <= length(target.centre) + target.radius_m;
}

// Finds the direction in which a sensor (relative to the target's centre) has every vertex in front
// of it, and the distance in front of the nearest one: towards the nearest place of the convex
// hull, by pairwise Frank-Wolfe steps (S. Lacoste-Julien, M. Jaggi, NIPS 28 (2015)). The steps may
// stop as soon as a plane between them is known. Depth 0: none was found.
struct Look {
  Vec<Body> forward;
  double depth_m = 0;
};
Look look_at_hull(const Target& target, Vec<Body> sensor) {
  const std::size_t vertices = target.vertex.size() / 3;
  const auto from_sensor = [&](std::size_t i) { return place_of(target, i) - sensor; };
  struct Weighted {
    std::size_t vertex;
    double weight;
  };
  std::vector<Weighted> mean = {{0, 1.0}};  // the present place of the hull
  Vec<Body> nearest = from_sensor(0);
  Look best;
  for (int step = 0; step < 1000; ++step) {
    const double distance = length(nearest);
    if (!(distance > 1e-6 * target.radius_m)) return best;
    std::size_t support = 0;
    double least = 1e300;
    for (std::size_t i = 0; i < vertices; ++i) {
      const double along = dot(nearest, from_sensor(i));
      if (along < least) {
        least = along;
        support = i;
      }
    }
    const double depth = least / distance;
    if (depth > best.depth_m) best = {(1 / distance) * nearest, depth};
    if (depth > 0.5 * distance) return best;
    auto away = mean.begin();
    for (auto it = mean.begin(); it != mean.end(); ++it)
      if (dot(nearest, from_sensor(it->vertex)) > dot(nearest, from_sensor(away->vertex)))
        away = it;
    const Vec<Body> to = from_sensor(support) - from_sensor(away->vertex);
    const double size2 = dot(to, to);
    if (!(size2 > 0)) return best;
    const double share = std::clamp(-dot(nearest, to) / size2, 0.0, away->weight);
    if (!(share > 0)) return best;
    nearest = nearest + share * to;
    away->weight -= share;
    if (away->weight <= 0) mean.erase(away);
    const auto known = std::find_if(mean.begin(), mean.end(),
                                    [&](const Weighted& w) { return w.vertex == support; });
    if (known != mean.end())
      known->weight += share;
    else
      mean.push_back({support, share});
  }
  return best;
}

}  // namespace

absl::Status check_outside(const Target& target, const Viewpoint& viewpoint) {
  if (!reaches_beyond(target, viewpoint.range_m)) return absl::OkStatus();
  const Vec<Body> sensor = viewpoint.range_m * body_from_aspect(viewpoint.aspect_azimuth_deg,
                                                                viewpoint.aspect_elevation_deg) -
                           target.centre;
  if (look_at_hull(target, sensor).depth_m > 0.01 * target.radius_m) return absl::OkStatus();
  return keyed_problem(
      "viewpoints.range_m",
      absl::StrCat("a sensor at ", viewpoint.range_m, " m, azimuth ", viewpoint.aspect_azimuth_deg,
                   ", elevation ", viewpoint.aspect_elevation_deg,
                   " deg is inside the target's convex hull or hardly outside; the target reaches ",
                   length(target.centre) + target.radius_m, " m from its reference point",
                   length(target.centre) + target.radius_m > 1000 ? " (is the model's unit right?)"
                   : viewpoint.range_m <= 100
                       ? absl::StrCat(" (is it in km? ", viewpoint.range_m, " km are ",
                                      1000 * viewpoint.range_m, " m)")
                       : ""));
}

ViewFrame make_view_frame(const Target& target, const Viewpoint& viewpoint) {
  ViewFrame frame;
  const Vec<Body> to_sensor =
      body_from_aspect(viewpoint.aspect_azimuth_deg, viewpoint.aspect_elevation_deg);
  frame.forward = -1.0 * to_sensor;
  // The derivative of the aspect direction with respect to elevation: defined at the zenith too.
  const double az = viewpoint.aspect_azimuth_deg * std::numbers::pi / 180;
  const double el = viewpoint.aspect_elevation_deg * std::numbers::pi / 180;
  frame.up = {-std::sin(el) * std::cos(az), -std::sin(el) * std::sin(az), -std::cos(el)};
  frame.sensor = viewpoint.range_m * to_sensor - target.centre;
  double nearest_m = 0;
  if (reaches_beyond(target, viewpoint.range_m)) {
    const Look look = look_at_hull(target, frame.sensor);
    frame.forward = look.forward;
    nearest_m = look.depth_m;
    const Vec<Body> upright = frame.up - dot(frame.up, frame.forward) * frame.forward;
    frame.up = length(upright) > 1e-6 ? (1 / length(upright)) * upright : to_sensor;
  }
  frame.right = cross(frame.forward, frame.up);
  // The plane touches the bounding sphere on the sensor's side; rays start there.
  const double to_centre = -dot(frame.sensor, frame.forward);
  frame.plane_m = nearest_m > 0 ? 0.999 * nearest_m
                                : std::max(to_centre - 1.0001 * target.radius_m, 0.01 * to_centre);
  return frame;
}

AimedView make_aimed_view(const Target& target, const Viewpoint& viewpoint,
                          const BrightFacets& bright) {
  AimedView view;
  view.range_m = viewpoint.range_m;
  ViewFrame& frame = view.frame = make_view_frame(target, viewpoint);

  const std::size_t vertices = target.vertex.size() / 3;
  PlaneVertices plane;
  std::vector<double>&x_m = plane.x_m, &y_m = plane.y_m;
  x_m.resize(vertices);
  y_m.resize(vertices);
  if (bright.past_others) plane.depth_m.resize(vertices);
  for (std::size_t i = 0; i < vertices; ++i) {
    const Vec<Body> q =
        Vec<Body>{target.vertex[3 * i], target.vertex[3 * i + 1], target.vertex[3 * i + 2]} -
        frame.sensor;
    const double depth_m = dot(q, frame.forward), scale = frame.plane_m / depth_m;
    x_m[i] = scale * dot(q, frame.right);
    y_m[i] = scale * dot(q, frame.up);
    if (bright.past_others) plane.depth_m[i] = depth_m;
  }
  const auto [x_min, x_max] = std::minmax_element(x_m.begin(), x_m.end());
  const auto [y_min, y_max] = std::minmax_element(y_m.begin(), y_m.end());
  // For pictures, add a margin against rounding; a target seen edge-on still gets a rectangle of
  // positive area.
  const double margin = 1e-5 * std::max(*x_max - *x_min, *y_max - *y_min);
  frame.x0_m = *x_min - margin;
  frame.y0_m = *y_min - margin;
  frame.width_m = *x_max - *x_min + 2 * margin;
  frame.height_m = *y_max - *y_min + 2 * margin;

  std::uint32_t strata = 1;
  for (const PartSpec& part : target.part) view.stratum_of_part.push_back(part.hot ? strata++ : 0);
  // 128 cells (kMaskCells) on the long side of each stratum's own rectangle: 90 % of the frigate's
  // rays then meet it, and a small hot spot on a large target is aimed at as well as a large one.
  view.bright = bright;
  std::vector<std::vector<std::uint32_t>> facets(strata + bright.group.size());
  if (!bright.group.empty()) {
    view.first_bright = strata;
    for (const Target::Facet& facet : target.facet)
      view.stratum_of_facet.push_back(view.stratum_of_part[facet.part]);
    for (const std::vector<std::uint32_t>& group : bright.group) {
      for (const std::uint32_t t : group) view.stratum_of_facet[t] = strata;
      ++strata;
    }
  }
  for (std::uint32_t t = 0; t < target.facet.size(); ++t)
    facets[view.stratum_of(t, target.facet[t].part)].push_back(t);
  const double size_m = std::max(frame.width_m, frame.height_m);
  for (std::size_t s = 0; s < facets.size(); ++s)
    if (bright.past_others && s > 0 && !facets[s].empty())
      view.stratum.emplace_back(visible_cells(target, plane, facets[s], size_m, kMaskCells));
    else
      view.stratum.emplace_back(target, bounds_of(target, frame, x_m, y_m, facets[s]), x_m, y_m,
                                facets[s], kMaskCells);
  return view;
}

FootprintView make_footprint_view(const Target& target, Vec<Body> sensor, Vec<Body> at,
                                  double width_m, double height_m) {
  FootprintView out;
  AimedView& view = out.view;
  ViewFrame& frame = view.frame;
  const Vec<Body> line = at - sensor;
  view.range_m = length(line);
  frame.forward = (1 / view.range_m) * line;
  frame.sensor = sensor - target.centre;
  // Across the vertical where there is a vertical (body z is down), else across the bow.
  const Vec<Body> across = cross(Vec<Body>{0, 0, 1}, frame.forward);
  frame.right = length(across) > 1e-6 ? (1 / length(across)) * across : Vec<Body>{0, 1, 0};
  frame.up = cross(frame.right, frame.forward);
  const double to_centre = -dot(frame.sensor, frame.forward);
  frame.plane_m = std::max(to_centre - 1.0001 * target.radius_m, 0.01 * view.range_m);
  const double scale = frame.plane_m / view.range_m;
  frame.width_m = width_m * scale;
  frame.height_m = height_m * scale;
  frame.x0_m = -0.5 * frame.width_m;
  frame.y0_m = -0.5 * frame.height_m;
  view.stratum_of_part.assign(target.part.size(), 0);
  view.stratum.push_back(CoverageMask::whole(frame));
  const double u = 0.5 * width_m / view.range_m, v = 0.5 * height_m / view.range_m;
  const double solid_angle_sr = 4 * std::asin(u * v / std::sqrt((1 + u * u) * (1 + v * v)));
  out.footprint_m2 = view.range_m * view.range_m * solid_angle_sr;
  return out;
}

AimedView whole_view(const AimedView& view) {
  AimedView out;
  out.range_m = view.range_m;
  out.frame = view.frame;
  out.stratum_of_part.assign(view.stratum_of_part.size(), 0);
  out.stratum = {CoverageMask::whole(view.frame)};
  return out;
}

}  // namespace irsig
