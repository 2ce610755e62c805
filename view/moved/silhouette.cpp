#include "view/moved/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace irsig {
namespace {

constexpr double kDegreeInRadians = std::numbers::pi / 180;
constexpr std::size_t kRows = 128, kCells = 256, kCorners = 64;

// The image plane of a sensor that looks at the reference point, at a distance of 1.
struct Camera {
  Camera(const Viewpoint& v)
      : elevation_rad(v.aspect_elevation_deg * kDegreeInRadians),
        towards(body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg)),
        forward(-1.0 * towards),
        range_m(v.range_m) {
    const double az = v.aspect_azimuth_deg * kDegreeInRadians, el = elevation_rad;
    up = {-std::sin(el) * std::cos(az), -std::sin(el) * std::sin(az), -std::cos(el)};
    right = cross(forward, up);
    sensor = range_m * towards;
  }
  struct Place {
    double x, y;
  };
  [[nodiscard]] Place place(Vec<Body> p) const {
    const Vec<Body> q = p - sensor;
    const double depth = dot(q, forward);
    return {dot(q, right) / depth, dot(q, up) / depth};
  }
  [[nodiscard]] double z(double x, double y) const {
    return (forward.z + y * up.z) / std::sqrt(1 + x * x + y * y);
  }
  // range^2 x solid angle for each unit of the plane.
  [[nodiscard]] double weight(double x, double y) const {
    const double r2 = 1 + x * x + y * y;
    return range_m * range_m / (r2 * std::sqrt(r2));
  }
  double elevation_rad;
  Vec<Body> towards, forward, up, right, sensor;
  double range_m;
};

// A facet that faces the sensor, above the waterline: convex, up to four corners.
struct Facet {
  std::array<Vec<Body>, 4> corner;
  std::size_t corners;
  Vec<Body> normal;
  std::uint32_t part;
};

template <typename Use>
void for_each_facing(const TargetShape& shape, Vec<Body> sensor, bool waterline, const Use& use) {
  for (std::size_t t = 0; t < shape.triangle.size(); ++t) {
    const auto& index = shape.triangle[t];
    const std::array<Vec<Body>, 3> p = {shape.vertex[index[0]], shape.vertex[index[1]],
                                        shape.vertex[index[2]]};
    Facet facet{{}, 0, cross(p[1] - p[0], p[2] - p[0]), shape.part[t]};
    const bool faces = dot(facet.normal, p[0] - sensor) < 0;
    if (!faces && !shape.two_sided[facet.part]) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec<Body>&a = p[i], &b = p[(i + 1) % 3];
      const bool dry = !waterline || a.z <= 0, next_dry = !waterline || b.z <= 0;
      if (dry) facet.corner[facet.corners++] = a;
      if (dry != next_dry) facet.corner[facet.corners++] = a + (a.z / (a.z - b.z)) * (b - a);
    }
    if (facet.corners >= 3) use(facet);
  }
}

struct Outline {
  std::array<Camera::Place, 4> corner;
  std::size_t corners;
  double low, high;
};

struct Span {
  double from, to;
};

// The union of spans, in place.
void unite(std::vector<Span>& spans) {
  std::sort(spans.begin(), spans.end(),
            [](const Span& a, const Span& b) { return a.from < b.from; });
  std::size_t last = 0;
  for (std::size_t i = 1; i < spans.size(); ++i) {
    if (spans[i].from <= spans[last].to)
      spans[last].to = std::max(spans[last].to, spans[i].to);
    else
      spans[++last] = spans[i];
  }
  if (!spans.empty()) spans.resize(last + 1);
}

// Where a row at height y meets a convex outline.
bool met(const Outline& outline, double y, Span& out) {
  out = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < outline.corners; ++i) {
    const auto &a = outline.corner[i], &b = outline.corner[(i + 1) % outline.corners];
    if ((a.y <= y) == (b.y <= y)) continue;
    const double x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
    out = {std::min(out.from, x), std::max(out.to, x)};
  }
  return out.from < out.to;
}

}  // namespace

Silhouette::Silhouette(const TargetShape& shape, const Viewpoint& viewpoint, bool waterline,
                       std::span<const float> horizon_z) {
  const Camera camera(viewpoint);
  std::vector<Outline> outlines;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  std::vector<double> breaks;
  for_each_facing(shape, camera.sensor, waterline, [&](const Facet& facet) {
    Outline& o = outlines.emplace_back();
    o.corners = facet.corners;
    o.low = std::numeric_limits<double>::infinity();
    o.high = -o.low;
    for (std::size_t i = 0; i < o.corners; ++i) {
      o.corner[i] = camera.place(facet.corner[i]);
      o.low = std::min(o.low, o.corner[i].y);
      o.high = std::max(o.high, o.corner[i].y);
      if (shape.triangle.size() <= kCorners) breaks.push_back(o.corner[i].y);
    }
    low = std::min(low, o.low);
    high = std::max(high, o.high);
  });
  if (!(low < high)) return;
  breaks.push_back(low);
  breaks.push_back(high);
  for (const float z : horizon_z) {
    // The horizon in the middle of the picture; towards the sides it is lower, by an amount that
    // the rows give.
    const double turn = camera.elevation_rad - std::asin(std::clamp<double>(z, -1.0, 1.0));
    const double y = std::tan(turn);
    if (std::abs(turn) < 1 && y > low && y < high) breaks.push_back(y);
  }
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end(),
                           [&](double a, double b) { return b - a < 1e-9 * (high - low); }),
               breaks.end());
  breaks.back() = high;

  struct Row {
    double y, height;
    bool fine;
    std::vector<Span> span;
  };
  std::vector<Row> rows;
  for (const bool fine : {true, false})
    for (std::size_t i = 1; i < breaks.size(); ++i) {
      const double share = (breaks[i] - breaks[i - 1]) / (high - low);
      const auto count = 2 + static_cast<std::size_t>(share * static_cast<double>(kRows));
      const std::size_t n = fine ? 2 * count : count;
      const double height = (breaks[i] - breaks[i - 1]) / static_cast<double>(n);
      for (std::size_t r = 0; r < n; ++r)
        rows.push_back({breaks[i - 1] + (static_cast<double>(r) + 0.5) * height, height, fine, {}});
    }
  const auto coarse = std::find_if(rows.begin(), rows.end(), [](const Row& r) { return !r.fine; });
  for (const Outline& o : outlines)
    for (auto [begin, end] : {std::pair{rows.begin(), coarse}, {coarse, rows.end()}}) {
      auto row =
          std::lower_bound(begin, end, o.low, [](const Row& r, double y) { return r.y < y; });
      Span span{};
      for (; row != end && row->y < o.high; ++row)
        if (met(o, row->y, span)) row->span.push_back(span);
    }
  for (Row& row : rows) {
    unite(row.span);
    Rows& to = row.fine ? fine_ : coarse_;
    const auto add = [&](double from, double until) {
      const double middle = 0.5 * (from + until), z = camera.z(middle, row.y);
      const double weight = camera.weight(from, row.y) + 4 * camera.weight(middle, row.y) +
                            camera.weight(until, row.y);
      const double area_m2 = (until - from) * row.height * weight / 6;
      to.piece.push_back({z, area_m2});
      to.area_m2 += area_m2;
      for (const double x : {from, until})
        for (const double y : {row.y - 0.5 * row.height, row.y + 0.5 * row.height}) {
          to.least_z = std::min(to.least_z, camera.z(x, y));
          to.most_z = std::max(to.most_z, camera.z(x, y));
        }
    };
    for (const Span& span : row.span) {
      // Cut where the row crosses a horizon, and so that a piece has one direction's z within a
      // fraction of a row.
      std::vector<double> cut{span.from, span.to};
      const auto at = [&](double x) {
        if (x > span.from && x < span.to) cut.push_back(x);
      };
      at(0);
      const double across = camera.forward.z + row.y * camera.up.z;
      for (const float z : horizon_z) {
        if (z == 0) continue;
        const double ratio = across / static_cast<double>(z);
        const double x2 = ratio * ratio - 1 - row.y * row.y;
        if (ratio > 0 && x2 > 0)
          for (const double x : {-std::sqrt(x2), std::sqrt(x2)}) at(x);
      }
      std::sort(cut.begin(), cut.end());
      for (std::size_t i = 1; i < cut.size(); ++i) {
        const double bend = std::abs(camera.z(cut[i], row.y) - camera.z(cut[i - 1], row.y));
        const int pieces = bend > 0.2 * row.height ? 6 : 1;
        for (int k = 0; k < pieces; ++k)
          add(cut[i - 1] + (cut[i] - cut[i - 1]) * k / pieces,
              cut[i - 1] + (cut[i] - cut[i - 1]) * (k + 1) / pieces);
      }
    }
  }
}

double Silhouette::area_error_m2() const { return std::abs(fine_.area_m2 - coarse_.area_m2); }

Silhouette::Fractions Silhouette::before(const BackgroundDirections& nodes) const {
  const auto sum = [&](const Rows& rows) {
    std::vector<double> out(nodes.count());
    for (const Piece& piece : rows.piece) {
      BackgroundDirections::Share share[2];
      const int count = nodes.shares(static_cast<float>(piece.z), share);
      for (int i = 0; i < count; ++i)
        out[share[i].node] += static_cast<double>(share[i].weight) * piece.area_m2 / rows.area_m2;
    }
    return out;
  };
  Fractions out{sum(fine_), sum(coarse_)};
  for (std::size_t n = 0; n < out.value.size(); ++n)
    out.error[n] = std::abs(out.error[n] - out.value[n]);
  return out;
}

PartAreas part_areas(const TargetShape& shape, const Viewpoint& viewpoint, bool waterline) {
  const Camera camera(viewpoint);
  struct Flat {
    Outline outline;
    // 1 / depth over the plane.
    double at_0, per_x, per_y, x0 = 0, x1 = 0;
    std::uint32_t part;
  };
  std::vector<Flat> facets;
  const double inf = std::numeric_limits<double>::infinity();
  double x0 = inf, x1 = -inf, y0 = inf, y1 = -inf;
  for_each_facing(shape, camera.sensor, waterline, [&](const Facet& facet) {
    // n . (depth (forward + x right + y up)) = n . (p - sensor)
    const double away = dot(facet.normal, facet.corner[0] - camera.sensor);
    if (away == 0) return;
    Flat f{{},
           dot(facet.normal, camera.forward) / away,
           dot(facet.normal, camera.right) / away,
           dot(facet.normal, camera.up) / away,
           inf,
           -inf,
           facet.part};
    f.outline = {{}, facet.corners, inf, -inf};
    for (std::size_t i = 0; i < facet.corners; ++i) {
      const Camera::Place p = f.outline.corner[i] = camera.place(facet.corner[i]);
      f.outline.low = std::min(f.outline.low, p.y);
      f.outline.high = std::max(f.outline.high, p.y);
      f.x0 = std::min(f.x0, p.x);
      f.x1 = std::max(f.x1, p.x);
    }
    x0 = std::min(x0, f.x0);
    x1 = std::max(x1, f.x1);
    y0 = std::min(y0, f.outline.low);
    y1 = std::max(y1, f.outline.high);
    facets.push_back(f);
  });
  const std::size_t parts = shape.two_sided.size();
  PartAreas out{std::vector<double>(parts), std::vector<double>(parts)};
  if (!(x0 < x1) || !(y0 < y1)) return out;
  const double dx = (x1 - x0) / kCells, dy = (y1 - y0) / kCells;
  struct Pixel {
    double nearness = 0;
    std::uint32_t part = std::numeric_limits<std::uint32_t>::max();
  };
  std::vector<Pixel> cell(kCells * kCells);
  for (const Flat& f : facets) {
    const auto first =
        static_cast<std::size_t>(std::max(0.0, std::ceil((f.outline.low - y0) / dy - 0.5)));
    for (std::size_t r = first; r < kCells; ++r) {
      const double y = y0 + (static_cast<double>(r) + 0.5) * dy;
      Span span{};
      if (y > f.outline.high) break;
      if (!met(f.outline, y, span)) continue;
      auto c = static_cast<std::size_t>(std::max(0.0, std::ceil((span.from - x0) / dx - 0.5)));
      for (; c < kCells; ++c) {
        const double x = x0 + (static_cast<double>(c) + 0.5) * dx;
        if (x > span.to) break;
        Pixel& here = cell[r * kCells + c];
        const double nearness = f.at_0 + x * f.per_x + y * f.per_y;
        if (nearness > here.nearness) here = {nearness, f.part};
      }
    }
  }
  std::vector<double> rim(parts);
  for (std::size_t r = 0; r < kCells; ++r)
    for (std::size_t c = 0; c < kCells; ++c) {
      const std::uint32_t part = cell[r * kCells + c].part;
      if (part >= parts) continue;
      out.area_m2[part] += dx * dy *
                           camera.weight(x0 + (static_cast<double>(c) + 0.5) * dx,
                                         y0 + (static_cast<double>(r) + 0.5) * dy);
      const auto same = [&](std::size_t row, std::size_t column) {
        return row < kCells && column < kCells && cell[row * kCells + column].part == part;
      };
      if (!same(r + 1, c) || !same(r - 1, c) || !same(r, c + 1) || !same(r, c - 1)) rim[part] += 1;
    }
  // The edge lies anywhere in its cell, alike along some eight of them.
  for (std::size_t p = 0; p < parts; ++p)
    out.error_m2[p] = std::sqrt(8 * rim[p] / 12) * dx * dy * camera.range_m * camera.range_m;
  return out;
}

std::vector<double> facet_changes(const TargetShape& shape, const Viewpoint& from,
                                  double to_range_m, bool waterline) {
  const Vec<Body> towards = body_from_aspect(from.aspect_azimuth_deg, from.aspect_elevation_deg);
  const std::size_t parts = shape.two_sided.size();
  struct Turned {
    double before_m2 = 0, after_m2 = 0;
    std::vector<std::array<double, 2>> facet;
    double nearest_m = -std::numeric_limits<double>::infinity(), farthest_m = -nearest_m;
  };
  std::vector<Turned> turned(parts);
  for (std::size_t t = 0; t < shape.triangle.size(); ++t) {
    const auto& index = shape.triangle[t];
    const Vec<Body>&a = shape.vertex[index[0]], &b = shape.vertex[index[1]],
          &c = shape.vertex[index[2]];
    const Vec<Body> middle = (1.0 / 3) * (a + b + c);
    if (waterline && middle.z > 0) continue;
    const Vec<Body> normal = cross(b - a, c - a);
    const auto seen = [&](double range_m) {
      const Vec<Body> q = range_m * towards - middle;
      const double r = length(q) / range_m, cosine = dot(normal, q) / (2 * range_m);
      const double m2 = cosine / (r * r * r);
      return shape.two_sided[shape.part[t]] ? std::abs(m2) : std::max(0.0, m2);
    };
    const double before = seen(from.range_m), after = seen(to_range_m);
    if (before == 0 && after == 0) continue;
    Turned& part = turned[shape.part[t]];
    part.before_m2 += before;
    part.after_m2 += after;
    part.facet.push_back({before, after});
    for (const Vec<Body>* v : {&a, &b, &c}) {
      part.nearest_m = std::max(part.nearest_m, dot(*v, towards));
      part.farthest_m = std::min(part.farthest_m, dot(*v, towards));
    }
  }
  std::vector<double> out(parts);
  for (std::size_t p = 0; p < parts; ++p) {
    const Turned& part = turned[p];
    if (part.facet.empty()) continue;
    const double whole = part.before_m2 > 0 ? part.after_m2 / part.before_m2 : 0;
    double changed = 0;
    for (const auto& [before, after] : part.facet) changed += std::abs(after - whole * before);
    const auto by_distance = [&](double z) {
      const double ratio = (1 - z / from.range_m) / (1 - z / to_range_m);
      return ratio * ratio;
    };
    out[p] = std::max(part.before_m2 > 0 ? changed / part.before_m2 : 1.0,
                      std::abs(by_distance(part.nearest_m) - by_distance(part.farthest_m)));
  }
  return out;
}

}  // namespace irsig
