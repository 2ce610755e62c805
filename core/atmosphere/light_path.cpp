#include "core/atmosphere/light_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "absl/strings/str_format.h"
#include "core/base/check.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

constexpr double kLongestStepM = 10e3;
constexpr double kHorizontal = 0.5 * std::numbers::pi;

// Steps also end at the profile's levels up to this height, between which its quantities are
// exponential.
constexpr double kLevelsMatterM = 60e3;

double largest_rise_m(double height_m) {
  return std::clamp(500 + 0.25 * (height_m - 6000), 500.0, 15e3);
}

// n - 1 in the infrared.                                                        [kneizys1988]
double refractivity(const AirLevel& air) {
  const double p_hpa = 1e-2 * air.pressure_pa;
  constexpr double kNu2 = 2000.0 * 2000.0;
  return 1e-6 * ((77.46 + 0.459e-8 * kNu2) * p_hpa / air.temperature_k -
                 1e-6 * air.gas.h2o_ppmv * p_hpa / 1013.25 * (43.49 - 0.347e-8 * kNu2));
}

struct Ray {  // zenith and angle in radians
  double height_m, zenith, angle;
};

struct Slope {
  double height, zenith, angle;
};

Slope slope_at(const AirProfile& air, const Ray& ray, bool refraction) {
  double gradient = 0;
  const double bottom = air.level.front().height_m, top = air.level.back().height_m;
  if (refraction && ray.height_m < top) {
    const double low = std::clamp(ray.height_m - 1, bottom, top - 2);
    gradient = 0.5 * (refractivity(air_at(air, low + 2)) - refractivity(air_at(air, low)));
  }
  const double r = kEarthRadiusM + ray.height_m, s = std::sin(ray.zenith);
  return {std::cos(ray.zenith), -s * (1 / r + gradient), s / r};
}

// Half a step with the slope `a` at the ray, then all of it with the slope there.
Ray advance(const AirProfile& air, const Ray& ray, const Slope& a, double step_m, bool refraction) {
  const double h = 0.5 * step_m;
  const Ray middle = {ray.height_m + h * a.height, ray.zenith + h * a.zenith,
                      ray.angle + h * a.angle};
  const Slope b = slope_at(air, middle, refraction);
  return {ray.height_m + step_m * b.height, ray.zenith + step_m * b.zenith,
          ray.angle + step_m * b.angle};
}

// Its height alone asks for no air but that at the ray.
double height_after(const Ray& ray, const Slope& a, double step_m) {
  return ray.height_m + step_m * std::cos(ray.zenith + 0.5 * step_m * a.zenith);
}

struct Trace {
  LightPath path;
  Ray last{};  // where the ray is after range_m, in air or not
  double lowest_m = 0;
};

class Tracer {
 public:
  Tracer(const AirProfile& air, bool refraction, bool stop_at_surface,
         double longest_step_m = kLongestStepM)
      : air_(air),
        refraction_(refraction),
        stop_at_surface_(stop_at_surface),
        longest_step_m_(longest_step_m),
        bottom_m_(air.level.front().height_m),
        top_m_(air.level.back().height_m) {
    double closest_m = top_m_ - bottom_m_;
    for (std::size_t i = 0; i + 1 < air.level.size(); ++i)
      closest_m = std::min(closest_m, air.level[i + 1].height_m - air.level[i].height_m);
    // Levels of a cloud: its humidity ends within a metre.
    if (closest_m < 2 * near_m_) near_m_ = std::max(1e-4 * closest_m, 1e-6);
  }

  Trace run(double height_m, double zenith_deg, double range_m) {
    Ray ray = {height_m, zenith_deg * kRadPerDeg, 0};
    Trace out;
    out.lowest_m = height_m;
    double left_m = range_m;
    if (height_m >= top_m_) {
      const double r = kEarthRadiusM + height_m, top = kEarthRadiusM + top_m_;
      const double closest = r * std::sin(ray.zenith);
      const double entry_m =
          -r * std::cos(ray.zenith) - std::sqrt(std::max(0.0, top * top - closest * closest));
      if (std::cos(ray.zenith) >= 0 || closest >= top || entry_m >= left_m) {
        return leave(std::move(out), ray, left_m, range_m);
      }
      ray = straight(ray, entry_m);
      ray.height_m = top_m_;
      left_m -= entry_m;
    }
    const double start_bend = ray.zenith + ray.angle;
    add_node(out.path, ray);
    while (left_m > 0) {
      double step_m = std::min({step_for(ray), longest_step_m_, left_m});
      const Slope slope = slope_at(air_, ray, refraction_);
      Ray next = advance(air_, ray, slope, step_m, refraction_);
      if (ray.zenith > kHorizontal + 1e-9 && next.zenith < kHorizontal) {
        // No step goes down and up again: it could dip below the surface unseen.
        double low = 0, high = step_m;
        for (int i = 0; i < 60 && high - low > 1e-7 * step_m; ++i) {
          const double middle = 0.5 * (low + high);
          (advance(air_, ray, slope, middle, refraction_).zenith < kHorizontal ? high : low) =
              middle;
        }
        step_m = high;
        next = advance(air_, ray, slope, step_m, refraction_);
      }
      const double level_m = first_level_between(ray.height_m, next.height_m);
      bool sinks = false, leaves = false;
      if (level_m >= 0) {
        // The crossing, by bisection of the step.
        const bool rising = next.height_m > ray.height_m;
        double low = 0, high = step_m;
        for (int i = 0; i < 60 && high - low > 1e-7 * step_m; ++i) {
          const double middle = 0.5 * (low + high);
          (rising == (height_after(ray, slope, middle) > level_m) ? high : low) = middle;
        }
        step_m = 0.5 * (low + high);
        next = advance(air_, ray, slope, step_m, refraction_);
        next.height_m = level_m;
        sinks = level_m == bottom_m_ && !rising;
        leaves = level_m == top_m_;
      }
      out.lowest_m = std::min(out.lowest_m, next.height_m);
      if (step_m > 0) {
        out.path.step_m.push_back(step_m);
        add_node(out.path, next);
      }
      left_m = std::max(0.0, left_m - step_m);
      ray = next;
      out.path.bending_deg = (ray.zenith + ray.angle - start_bend) / kRadPerDeg;
      if (sinks) {
        out.path.end = PathEnd::kSurface;
        out.path.length_m = range_m - left_m;
        if (!std::isfinite(range_m)) out.path.length_m = travelled(out.path, height_m);
        out.last = ray;
        return out;
      }
      if (leaves) return leave(std::move(out), ray, left_m, range_m);
    }
    out.path.length_m = range_m;
    out.last = ray;
    return out;
  }

 private:
  // The first level of the profile that lies strictly between two heights, seen from the first; -1
  // if none. The surface counts only if the ray is to stop there.
  [[nodiscard]] double first_level_between(double from_m, double to_m) const {
    double found = -1;
    for (const AirLevel& l : air_.level) {
      const double h = l.height_m;
      const bool end = h == top_m_ || (h == bottom_m_ && stop_at_surface_);
      if (!end && (h > kLevelsMatterM || h == bottom_m_)) continue;
      const bool crossed = to_m > from_m ? h > from_m + (end ? 0 : near_m_) && h < to_m
                                         : h < from_m - (end ? 0 : near_m_) && h > to_m;
      // A ray that starts on the surface and sinks, or at the top and rises, stops where it is.
      const bool stuck =
          end && (h == bottom_m_ ? from_m <= h && to_m < h : from_m >= h && to_m > h);
      if (!crossed && !stuck) continue;
      if (found < 0 || std::abs(h - from_m) < std::abs(found - from_m)) found = h;
    }
    return found;
  }

  static void add_node(LightPath& path, const Ray& ray) {
    path.node.push_back({ray.height_m, ray.zenith / kRadPerDeg, ray.angle / kRadPerDeg});
  }

  // Outside the air.
  static Ray straight(const Ray& ray, double distance_m) {
    const double r = kEarthRadiusM + ray.height_m;
    const double x = distance_m * std::sin(ray.zenith), y = r + distance_m * std::cos(ray.zenith);
    const double turn = std::atan2(x, y);
    return {std::hypot(x, y) - kEarthRadiusM, ray.zenith - turn, ray.angle + turn};
  }

  static Trace leave(Trace out, const Ray& ray, double left_m, double range_m) {
    out.path.length_m = range_m;
    if (std::isfinite(left_m)) {
      out.path.end = PathEnd::kRange;
      out.last = straight(ray, left_m);
    } else {
      out.path.end = PathEnd::kSpace;
      out.last = ray;
    }
    return out;
  }

  // The observer may be above the air.
  [[nodiscard]] double travelled(const LightPath& path, double height_m) const {
    double sum = 0;
    for (const double s : path.step_m) sum += s;
    if (height_m > top_m_) {
      const double r = kEarthRadiusM + height_m, top = kEarthRadiusM + top_m_;
      const double angle = path.node.front().central_angle_deg * kRadPerDeg;
      sum += std::sqrt(r * r + top * top - 2 * r * top * std::cos(angle));
    }
    return sum;
  }

  // The length over which a straight ray changes its height by the largest rise: the positive root
  // of |cos| s + s^2 / 2r = rise.
  static double step_for(const Ray& ray) {
    const double rise = largest_rise_m(ray.height_m), c = std::abs(std::cos(ray.zenith));
    return 2 * rise / (c + std::sqrt(c * c + 2 * rise / kEarthRadiusM));
  }

  const AirProfile& air_;
  bool refraction_, stop_at_surface_;
  double longest_step_m_, bottom_m_, top_m_;
  double near_m_ = 1;  // levels so near to a ray are passed without a node
};

}  // namespace

double lowest_height_m(const LightPath& path) {
  double out = std::numeric_limits<double>::infinity();
  for (const LightPath::Node& node : path.node) out = std::min(out, node.height_m);
  return out;
}

LightPath look(const AirProfile& air, double height_m, double zenith_deg, double range_m,
               bool refraction) {
  IRSIG_CHECK(height_m >= air.level.front().height_m);
  IRSIG_CHECK(zenith_deg >= 0);
  IRSIG_CHECK(zenith_deg <= 180);
  IRSIG_CHECK(range_m >= 0);
  return Tracer(air, refraction, true).run(height_m, zenith_deg, range_m).path;
}

LightPath level_path(double height_m, double range_m) {
  IRSIG_CHECK(range_m >= 0);
  const double turn_deg = range_m / (kEarthRadiusM + height_m) / kRadPerDeg;
  LightPath path;
  path.node = {{height_m, 90, 0}, {height_m, 90, turn_deg}};
  path.step_m = {range_m};
  path.length_m = range_m;
  return path;
}

absl::StatusOr<LightPath> look_between(const AirProfile& air, double observer_height_m,
                                       double target_height_m, double range_m, bool refraction) {
  const double bottom_m = air.level.front().height_m;
  for (const double h : {observer_height_m, target_height_m}) {
    if (!(h >= bottom_m && std::isfinite(h))) {
      return absl::InvalidArgumentError(
          absl::StrFormat("height_m %g: expected at least %g, the surface", h, bottom_m));
    }
  }
  const double r1 = kEarthRadiusM + observer_height_m, r2 = kEarthRadiusM + target_height_m;
  const double rise = std::abs(target_height_m - observer_height_m);
  if (!(range_m >= rise * (1 - 1e-9) && range_m <= r1 + r2)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "range_m %g: expected at least %g, the difference of the heights", range_m, rise));
  }
  Tracer tracer(air, refraction, false);
  if (range_m == 0) return tracer.run(observer_height_m, 0, 0).path;

  // (r2^2 - r1^2 - d^2) / (2 r1 d) without the loss of digits
  const double cos_zenith = std::clamp(
      ((target_height_m - observer_height_m) * (r2 + r1) - range_m * range_m) / (2 * r1 * range_m),
      -1.0, 1.0);
  double zenith = std::acos(cos_zenith);
  const double x = range_m * std::sin(zenith), y = range_m * cos_zenith;  // from the observer
  Trace trace;
  for (int i = 0; i < 8; ++i) {
    trace = tracer.run(observer_height_m, std::clamp(zenith, 0.0, std::numbers::pi) / kRadPerDeg,
                       range_m);
    const double r = kEarthRadiusM + trace.last.height_m;
    const double reached_x = r * std::sin(trace.last.angle);
    const double reached_y =  // r cos(angle) - r1
        trace.last.height_m - observer_height_m -
        2 * r * std::pow(std::sin(trace.last.angle / 2), 2);
    const double miss = std::atan2(reached_x, reached_y) - std::atan2(x, y);
    if (!refraction || std::abs(miss) * range_m < 1e-3) break;
    zenith -= miss;
  }
  if (trace.lowest_m < bottom_m - (0.01 + 2e-7 * range_m)) {
    return absl::OutOfRangeError(absl::StrFormat(
        "the Earth hides a point %g m high from one %g m high, %g m away: the line of sight runs "
        "%.3g m below the surface",
        target_height_m, observer_height_m, range_m, bottom_m - trace.lowest_m));
  }
  for (LightPath::Node& node : trace.path.node) node.height_m = std::max(node.height_m, bottom_m);
  return std::move(trace.path);
}

GrazingRay::GrazingRay(const AirProfile& air, bool refraction)
    : bottom_m_(air.level.front().height_m) {
  if (!refraction) return;
  // Steps of 10 km would err by 0.02 m each.
  constexpr double kStepM = 2e3;
  const LightPath path = Tracer(air, true, true, kStepM)
                             .run(bottom_m_, 90, std::numeric_limits<double>::infinity())
                             .path;
  if (path.end != PathEnd::kSpace) return;
  for (const LightPath::Node& n : path.node) {
    point_.push_back(
        {n.height_m, n.central_angle_deg * kRadPerDeg, (90 - n.zenith_deg) * kRadPerDeg});
  }
}

// Hermite's cubic between two points.
struct GrazingRay::Piece {
  double a_m, b_m, slope_a, slope_b;
  Piece(const Point& a, const Point& b) : a_m(a.height_m), b_m(b.height_m) {
    const double width = b.angle - a.angle;  // dh/d(angle) = r tan(elevation)
    slope_a = width * (kEarthRadiusM + a_m) * std::tan(a.elevation);
    slope_b = width * (kEarthRadiusM + b_m) * std::tan(b.elevation);
  }
  [[nodiscard]] double at(double t) const {
    const double u = 1 - t;
    return u * u * (1 + 2 * t) * a_m + t * t * (3 - 2 * t) * b_m +
           t * u * (u * slope_a - t * slope_b);
  }
};

double GrazingRay::height_m(double angle_rad) const {
  const double angle = std::abs(angle_rad), bottom = kEarthRadiusM + bottom_m_;
  if (point_.empty()) {  // bottom / cos - bottom
    const double s = std::sin(0.5 * angle);
    return bottom_m_ + 2 * bottom * s * s / std::cos(angle);
  }
  if (angle >= point_.back().angle) {
    const Point& p = point_.back();
    const double level = (kEarthRadiusM + p.height_m) * std::cos(p.elevation);
    return level / std::cos(p.elevation + angle - p.angle) - kEarthRadiusM;
  }
  const auto next = std::upper_bound(point_.begin() + 1, point_.end() - 1, angle,
                                     [](double x, const Point& p) { return x < p.angle; });
  const Point &a = *std::prev(next), &b = *next;
  return Piece(a, b).at((angle - a.angle) / (b.angle - a.angle));
}

double GrazingRay::angle_rad(double height_m) const {
  const double height = std::max(height_m, bottom_m_);
  if (point_.empty()) {
    const double rise = height - bottom_m_, r = kEarthRadiusM + height;
    return 2 * std::asin(std::sqrt(rise / (2 * r)));  // acos(bottom / r)
  }
  const Point& top = point_.back();
  if (height >= top.height_m) {
    const double level = (kEarthRadiusM + top.height_m) * std::cos(top.elevation);
    return top.angle + std::acos(level / (kEarthRadiusM + height)) - top.elevation;
  }
  const auto next = std::upper_bound(point_.begin() + 1, point_.end() - 1, height,
                                     [](double x, const Point& p) { return x < p.height_m; });
  const Point &a = *std::prev(next), &b = *next;
  const Piece piece(a, b);
  double low = 0, high = 1;
  for (int i = 0; i < 52; ++i) {
    const double t = 0.5 * (low + high);
    (piece.at(t) < height ? low : high) = t;
  }
  return a.angle + 0.5 * (low + high) * (b.angle - a.angle);
}

double GrazingRay::dip_rad(double height_m) const {
  const double angle = angle_rad(height_m);
  if (point_.empty()) return angle;
  const Point& top = point_.back();
  if (angle >= top.angle) return top.elevation + angle - top.angle;
  const auto next = std::upper_bound(point_.begin() + 1, point_.end() - 1, angle,
                                     [](double x, const Point& p) { return x < p.angle; });
  const Point &a = *std::prev(next), &b = *next;
  return a.elevation + (b.elevation - a.elevation) * (angle - a.angle) / (b.angle - a.angle);
}

double GrazingRay::bending_rad(double height_m) const {
  return angle_rad(height_m) - dip_rad(height_m);
}

}  // namespace irsig
