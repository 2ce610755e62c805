#include "tests/benchmark/paper_ray_facet.h"

#include <cmath>
#include <limits>

namespace irsig {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <typename V>
V minus(const V& a, const V& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename V>
V cross(const V& a, const V& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename V>
auto dot(const V& a, const V& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename Real>
std::vector<Point3> rounded(const std::vector<float>& vertex, double offset_m) {
  std::vector<Point3> out;
  for (std::size_t i = 0; i < vertex.size(); i += 3) {
    Point3 at;
    for (std::size_t j = 0; j < 3; ++j)
      at[j] = static_cast<double>(static_cast<Real>(static_cast<double>(vertex[i + j]) + offset_m));
    out.push_back(at);
  }
  return out;
}

}  // namespace

template <typename Real>
PaperTracer<Real>::PaperTracer(const std::vector<float>& vertex,
                               std::vector<std::uint32_t> triangle, double offset_m)
    : offset_m_(offset_m),
      triangle_(std::move(triangle)),
      tree_(rounded<Real>(vertex, offset_m), triangle_) {
  for (const Point3& at : rounded<Real>(vertex, offset_m))
    vertex_.push_back(
        {static_cast<Real>(at[0]), static_cast<Real>(at[1]), static_cast<Real>(at[2])});
  for (std::size_t i = 0; i < triangle_.size(); i += 3) {
    const Vector &a = vertex_[triangle_[i]], &b = vertex_[triangle_[i + 1]],
                 &c = vertex_[triangle_[i + 2]];
    const Vector n = cross(minus(b, a), minus(c, a));
    const Real size = std::sqrt(dot(n, n));
    normal_.push_back({n.x / size, n.y / size, n.z / size});
  }
}

template <typename Real>
double PaperTracer<Real>::distance(std::uint32_t facet, const Vector& origin,
                                   const Vector& direction, PaperTest test) const {
  const Vector& n = normal_[facet];
  const Vector* corner[3];
  for (std::size_t k = 0; k < 3; ++k) corner[k] = &vertex_[triangle_[3 * std::size_t{facet} + k]];
  const Real along = dot(n, direction);
  const Real t = dot(n, minus(*corner[0], origin)) / along;
  if (!(t >= 0)) return kInfinity;  // behind, or parallel, or a facet without area
  Vector from = origin, axis = direction;
  Real sign = along < 0 ? Real{-1} : Real{1};
  if (test == PaperTest::kRtm) {
    from = {origin.x + t * direction.x, origin.y + t * direction.y, origin.z + t * direction.z};
    axis = n;
    sign = 1;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector r = minus(*corner[k], from), next = minus(*corner[(k + 1) % 3], from);
    if (sign * dot(cross(r, next), axis) < 0) return kInfinity;
  }
  return static_cast<double>(t);
}

template <typename Real>
ReferenceTracer::Hit PaperTracer<Real>::nearest(const Point3& origin, const Point3& direction,
                                                PaperTest test) const {
  const auto moved = [&](std::size_t j) { return static_cast<Real>(origin[j] + offset_m_); };
  const Vector o{moved(0), moved(1), moved(2)};
  const Vector d{static_cast<Real>(direction[0]), static_cast<Real>(direction[1]),
                 static_cast<Real>(direction[2])};
  ReferenceTracer::Hit best;
  tree_.for_candidates(
      {static_cast<double>(o.x), static_cast<double>(o.y), static_cast<double>(o.z)}, direction,
      [&](std::uint32_t facet) {
        const double t = distance(facet, o, d, test);
        if (t < (best.met() ? best.t : kInfinity)) best = {facet, false, t};
        return best.met() ? best.t : kInfinity;
      });
  return best;
}

template class PaperTracer<float>;
template class PaperTracer<double>;

}  // namespace irsig
