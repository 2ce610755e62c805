#include "verify/watertight/hit_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace irsig {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double length3(const Point3& v) { return std::hypot(v[0], v[1], v[2]); }

Point3 cross3(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Two unit vectors across a direction.
std::pair<Point3, Point3> across(const Point3& d) {
  const auto shorter = [&](std::size_t i, std::size_t j) {
    return std::abs(d[i]) < std::abs(d[j]) ? i : j;
  };
  Point3 axis{};
  axis[shorter(shorter(0, 1), 2)] = 1;
  Point3 v = cross3(d, axis);
  const double v_length = length3(v), d_length = length3(d);
  for (double& x : v) x /= v_length;
  Point3 u = cross3(v, d);
  for (double& x : u) x /= d_length;
  return {u, v};
}

}  // namespace

HitJudge::HitJudge(const Mesh& mesh) : reference_(centred(mesh)) {
  for (std::size_t i = 0; i < vertex_.size(); i += 3)
    radius_m_ = std::max(radius_m_, length3({vertex_[i], vertex_[i + 1], vertex_[i + 2]}));
}

// As make_target() does it.
ReferenceTracer HitJudge::centred(const Mesh& mesh) {
  Vec<Body> low = mesh.vertex.front(), high = low;
  for (const Vec<Body>& v : mesh.vertex) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  const Vec<Body> centre = 0.5 * (low + high), half = 0.5 * (high - low);
  half_size_ = {half.x, half.y, half.z};
  std::vector<Point3> exact;
  exact.reserve(mesh.vertex.size());
  vertex_.reserve(3 * mesh.vertex.size());
  for (const Vec<Body>& v : mesh.vertex) {
    const Vec<Body> d = v - centre;
    for (const double x : {d.x, d.y, d.z}) vertex_.push_back(static_cast<float>(x));
    exact.push_back({vertex_[vertex_.size() - 3], vertex_[vertex_.size() - 2], vertex_.back()});
  }
  triangle_.reserve(3 * mesh.triangle.size());
  for (const auto& t : mesh.triangle) triangle_.insert(triangle_.end(), t.begin(), t.end());
  return {std::move(exact), triangle_};
}

HitJudge::Hit HitJudge::truth(const Ray& ray) const {
  return reference_.nearest(ray.origin, ray.direction, 0, kInfinity);
}

HitJudge::Verdict HitJudge::judge(const Ray& ray, const Hit& truth, const Hit& answer) const {
  const double ray_length = length3(ray.direction);
  if (same(truth, answer, ray_length)) return Verdict::kRight;
  const bool in_front = answer.met() && (!truth.met() || answer.t < truth.t);
  if (in_front && passes_close(ray, answer.facet)) return Verdict::kWithinTolerance;
  if (some_nearby(ray, [&](const Hit& hit) { return same(hit, answer, ray_length); }))
    return Verdict::kWithinTolerance;
  return in_front ? Verdict::kInvented : Verdict::kLost;
}

bool HitJudge::blocked_nearby(const Ray& ray, double t_max, bool blocked) const {
  return some_nearby(ray, [&](const Hit& hit) { return (hit.met() && hit.t <= t_max) == blocked; });
}

bool HitJudge::same(const Hit& truth, const Hit& answer, double ray_length) const {
  if (truth.met() != answer.met()) return false;
  return truth.facet == answer.facet ||
         std::abs(truth.t - answer.t) * ray_length <= 4 * tolerance_m();
}

template <typename Accept>
bool HitJudge::some_nearby(const Ray& ray, Accept&& accept) const {
  const auto [u, v] = across(ray.direction);
  for (const double part : {1.0, 0.5, 0.25, 0.125}) {
    for (int k = 0; k < 16; ++k) {
      const double angle = k * std::numbers::pi / 8, by = part * tolerance_m();
      Ray moved = ray;
      for (std::size_t j = 0; j < 3; ++j)
        moved.origin[j] += by * (std::cos(angle) * u[j] + std::sin(angle) * v[j]);
      if (accept(truth(moved))) return true;
    }
  }
  return false;
}

// Returns true if the ray, seen along its direction, passes an edge of the facet within the
// tolerance.
bool HitJudge::passes_close(const Ray& ray, std::uint32_t facet) const {
  const auto [u, v] = across(ray.direction);
  double x[3]{}, y[3]{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float* at = &vertex_[3 * std::size_t{triangle_[3 * std::size_t{facet} + k]}];
    for (std::size_t j = 0; j < 3; ++j) {
      x[k] += (static_cast<double>(at[j]) - ray.origin[j]) * u[j];
      y[k] += (static_cast<double>(at[j]) - ray.origin[j]) * v[j];
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double ex = x[(k + 1) % 3] - x[k], ey = y[(k + 1) % 3] - y[k];
    const double squared = ex * ex + ey * ey;
    const double s = squared > 0 ? std::clamp(-(x[k] * ex + y[k] * ey) / squared, 0.0, 1.0) : 0.0;
    if (std::hypot(x[k] + s * ex, y[k] + s * ey) <= tolerance_m()) return true;
  }
  return false;
}

}  // namespace irsig
