#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/geo/frames.h"
#include "core/geo/viewpoint.h"

namespace irsig {

// A black convex body. Its intensity is a closed form: the sum of radiance times projected area
// over the facets that face the sensor.
struct ConvexBody {
  struct Facet {
    Vec<Body> normal;
    double area_m2;
    double radiance_w_m2_sr;
  };
  struct Cylinder {
    Vec<Body> axis;
    double side_m2, end_m2;  // 2 radius height, pi radius^2
    double radiance_w_m2_sr;
  };
  std::vector<Facet> facet;
  std::vector<Cylinder> cylinder;

  // Returns the sum over surfaces of their radiance less that of the background; 0: the intensity.
  // [W/sr]
  [[nodiscard]] double contrast_w_sr(Vec<Body> d, double background_w_m2_sr) const {
    double sum = 0;
    for (const Facet& f : facet)
      sum +=
          (f.radiance_w_m2_sr - background_w_m2_sr) * f.area_m2 * std::max(0.0, dot(f.normal, d));
    for (const Cylinder& c : cylinder) {
      const double along = std::abs(dot(c.axis, d));
      sum += (c.radiance_w_m2_sr - background_w_m2_sr) *
             (c.side_m2 * std::sqrt(std::max(0.0, 1 - along * along)) + c.end_m2 * along);
    }
    return sum;
  }
};

inline constexpr double kBodyRadiance = 30;  // W/(m2 sr)

using SceneRandom = std::mt19937_64;
inline double uniform(SceneRandom& random, double low, double high) {
  return low + (high - low) * std::uniform_real_distribution<double>()(random);
}
inline bool happens(SceneRandom& random, double probability) {
  return uniform(random, 0, 1) < probability;
}
template <typename T>
T any_of(SceneRandom& random, const std::vector<T>& of) {
  return of[std::uniform_int_distribution<std::size_t>(0, of.size() - 1)(random)];
}
inline Vec<Body> any_direction(SceneRandom& random) {
  const double z = uniform(random, -1, 1), turn = uniform(random, 0, 2 * std::numbers::pi);
  const double c = std::sqrt(1 - z * z);
  return {c * std::cos(turn), c * std::sin(turn), z};
}

// An upright prism of equal sides, of radius 3 m, the first of which faces the azimuth; of two
// sides: a thin plate without ends.
inline ConvexBody upright_prism(int sides, double azimuth_deg, double height_m) {
  constexpr double kRadius = 3;
  const double turn = 2 * std::numbers::pi / sides;
  ConvexBody out;
  for (int k = 0; k < sides; ++k)
    out.facet.push_back({body_from_aspect(azimuth_deg + 360.0 * k / sides, 0),
                         2 * kRadius * std::sin(0.5 * turn) * height_m, kBodyRadiance});
  if (sides == 2) return out;
  const double end_m2 = 0.5 * sides * kRadius * kRadius * std::sin(turn);
  for (const double z : {1.0, -1.0}) out.facet.push_back({{0, 0, z}, end_m2, kBodyRadiance});
  return out;
}
inline ConvexBody upright_cylinder(double height_m) {
  return {{}, {{{0, 0, 1}, 6 * height_m, 9 * std::numbers::pi, kBodyRadiance}}};
}
inline ConvexBody upright_box(double length_m, double width_m, double height_m,
                              double azimuth_deg) {
  ConvexBody out;
  for (const double side : {0.0, 180.0}) {
    const double z = side > 0 ? 1 : -1;
    out.facet.push_back(
        {body_from_aspect(azimuth_deg + side, 0), width_m * height_m, kBodyRadiance});
    out.facet.push_back(
        {body_from_aspect(azimuth_deg + 90 + side, 0), length_m * height_m, kBodyRadiance});
    out.facet.push_back({{0, 0, z}, width_m * length_m, kBodyRadiance});
  }
  return out;
}

struct Frame {
  Vec<Body> x, y, z;
  [[nodiscard]] Vec<Body> turned(Vec<Body> v) const { return v.x * x + v.y * y + v.z * z; }
};
inline Frame any_frame(SceneRandom& random) {
  const Vec<Body> z = any_direction(random);
  const Vec<Body> x = normalized(cross(z, any_direction(random)));
  return {x, cross(z, x), z};
}

// The body turned in any way.
inline ConvexBody tilted(ConvexBody body, SceneRandom& random) {
  const Frame frame = any_frame(random);
  const auto turned = [&](Vec<Body> v) { return frame.turned(v); };
  for (auto& f : body.facet) f.normal = turned(f.normal);
  for (auto& c : body.cylinder) c.axis = turned(c.axis);
  return body;
}

// The area that two disks of radius 1 have in common.
inline double lens_m2(double apart) {
  if (apart >= 2) return 0;
  return 2 * std::acos(apart / 2) - apart / 2 * std::sqrt(4 - apart * apart);
}

// Outlines of boxes as a far sensor has them: convex polygons, counterclockwise.
struct PlanePoint {
  double x, y;
};
inline double turn_of(PlanePoint a, PlanePoint b, PlanePoint c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
inline double area_m2(const std::vector<PlanePoint>& polygon) {
  double sum = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += 0.5 * turn_of(polygon[0], polygon[i - 1], polygon[i]);
  return sum;
}
struct SolidBox {
  Vec<Body> centre, half;  // in the frame
};
inline std::vector<PlanePoint> outline(const SolidBox& box, const Frame& frame, Vec<Body> d) {
  const Vec<Body> aside = std::abs(d.z) < 0.9 ? Vec<Body>{0, 0, 1} : Vec<Body>{1, 0, 0};
  const Vec<Body> right = normalized(cross(d, aside)), up = cross(d, right);
  std::vector<PlanePoint> corner;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        const Vec<Body> at =
            frame.turned(box.centre + Vec<Body>{x * box.half.x, y * box.half.y, z * box.half.z});
        corner.push_back({dot(at, right), dot(at, up)});
      }
  std::sort(corner.begin(), corner.end(),
            [](PlanePoint a, PlanePoint b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<PlanePoint> hull;  // Andrew's monotone chain
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const PlanePoint p : corner) {
      while (hull.size() >= first + 2 && turn_of(hull[hull.size() - 2], hull.back(), p) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(corner.begin(), corner.end());
  }
  return hull;
}
// Returns the intersection of two convex polygons (Sutherland and Hodgman).
inline std::vector<PlanePoint> common(std::vector<PlanePoint> inside,
                                      const std::vector<PlanePoint>& by) {
  for (std::size_t k = 0; k < by.size(); ++k) {
    const PlanePoint a = by[k], b = by[(k + 1) % by.size()];
    std::vector<PlanePoint> kept;
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const PlanePoint p = inside[i], q = inside[(i + 1) % inside.size()];
      const double at_p = turn_of(a, b, p), at_q = turn_of(a, b, q);
      if (at_p >= 0) kept.push_back(p);
      if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) {
        const double t = at_p / (at_p - at_q);
        kept.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
      }
    }
    inside = std::move(kept);
  }
  return inside;
}

}  // namespace irsig
