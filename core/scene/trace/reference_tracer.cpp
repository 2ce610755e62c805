#include "core/scene/trace/reference_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace irsig {
namespace {

constexpr std::uint32_t kLeaf = 4;
constexpr double kSame = 1e-14;

}  // namespace

ReferenceTracer::ReferenceTracer(std::vector<Point3> vertex, std::vector<std::uint32_t> triangle)
    : vertex_(std::move(vertex)), triangle_(std::move(triangle)), order_(triangle_.size() / 3) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (order_.empty()) return;
  std::vector<Point3> centre(order_.size());
  for (std::size_t f = 0; f < centre.size(); ++f)
    for (std::size_t j = 0; j < 3; ++j)
      centre[f][j] = (vertex_[triangle_[3 * f]][j] + vertex_[triangle_[3 * f + 1]][j] +
                      vertex_[triangle_[3 * f + 2]][j]) /
                     3;
  node_.reserve(order_.size());
  node_.push_back({{}, {}, 0, static_cast<std::uint32_t>(order_.size())});
  split(0, centre);
}

// Halves at the median along the longest side of the centres' box: depth 20 for a million facets.
void ReferenceTracer::split(std::uint32_t at, std::vector<Point3>& centre) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::uint32_t first = node_[at].first, count = node_[at].count;
  Point3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  Point3 centre_low = low, centre_high = high;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = vertex_[triangle_[3 * order_[i] + k]][j];
        low[j] = std::min(low[j], x);
        high[j] = std::max(high[j], x);
      }
      centre_low[j] = std::min(centre_low[j], centre[order_[i]][j]);
      centre_high[j] = std::max(centre_high[j], centre[order_[i]][j]);
    }
  }
  // A box test in rounded arithmetic must not lose what exact arithmetic would meet.
  for (std::size_t j = 0; j < 3; ++j) {
    const double margin = 0x1p-48 * std::max(std::abs(low[j]), std::abs(high[j])) +
                          0x1p-44 * (high[j] - low[j]) + 1e-200;
    low[j] -= margin;
    high[j] += margin;
  }
  node_[at].low = low;
  node_[at].high = high;
  if (count <= kLeaf) return;
  std::size_t axis = 0;
  for (std::size_t j = 1; j < 3; ++j)
    if (centre_high[j] - centre_low[j] > centre_high[axis] - centre_low[axis]) axis = j;
  const std::uint32_t half = count / 2;
  std::nth_element(
      order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
      [&](std::uint32_t a, std::uint32_t b) { return centre[a][axis] < centre[b][axis]; });
  const auto left = static_cast<std::uint32_t>(node_.size());
  node_.push_back({{}, {}, first, half});
  node_.push_back({{}, {}, first + half, count - half});
  node_[at].first = left;
  node_[at].count = 0;
  split(left, centre);
  split(left + 1, centre);
}

FacetHit ReferenceTracer::test(std::uint32_t facet, const Point3& origin,
                               const Point3& direction) const {
  const std::uint32_t* corner = &triangle_[3 * std::size_t{facet}];
  return exact_facet_hit(origin, direction, vertex_[corner[0]], vertex_[corner[1]],
                         vertex_[corner[2]]);
}

template <typename Visit>
void ReferenceTracer::walk(const Point3& origin, const Point3& direction, double t_min,
                           double& t_max, Visit&& visit) const {
  if (node_.empty()) return;
  Point3 inverse;
  for (std::size_t j = 0; j < 3; ++j) inverse[j] = 1 / direction[j];
  // Entry into a box, infinite where it is missed. Differences of origin and box are rounded once:
  // 2^-50 of the larger one stands for that.
  const auto entry = [&](const Node& node) {
    double near = t_min, far = t_max;
    for (std::size_t j = 0; j < 3; ++j) {
      const double margin = 0x1p-50 * std::abs(origin[j]);
      const double low = node.low[j] - origin[j] - margin, high = node.high[j] - origin[j] + margin;
      if (direction[j] == 0) {
        if (low > 0 || high < 0) return std::numeric_limits<double>::infinity();
        continue;
      }
      const double a = low * inverse[j], b = high * inverse[j];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    return near <= far + kSame * std::abs(far) ? near : std::numeric_limits<double>::infinity();
  };
  struct Open {
    std::uint32_t node;
    double near;
  };
  Open stack[64];
  std::size_t depth = 0;
  if (std::isinf(entry(node_[0]))) return;
  stack[depth++] = {0, t_min};
  while (depth > 0) {
    const Open open = stack[--depth];
    if (open.near > t_max + kSame * std::abs(t_max)) continue;
    const Node& node = node_[open.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) visit(order_[i]);
      continue;
    }
    const double left = entry(node_[node.first]), right = entry(node_[node.first + 1]);
    const Open children[2] = {{node.first, left}, {node.first + 1, right}};
    const std::size_t nearer = left <= right ? 0 : 1;
    for (const Open& child : {children[1 - nearer], children[nearer]})
      if (!std::isinf(child.near)) stack[depth++] = child;
  }
}

template <typename Visit>
void ReferenceTracer::walk_hits(const Point3& origin, const Point3& direction, double t_min,
                                double& t_max, Visit&& visit) const {
  walk(origin, direction, t_min, t_max, [&](std::uint32_t facet) {
    const FacetHit hit = test(facet, origin, direction);
    if (hit.met && hit.t >= t_min && hit.t <= t_max + kSame * std::abs(t_max))
      visit(Hit{facet, hit.front, hit.t});
  });
}

void ReferenceTracer::for_candidates(const Point3& origin, const Point3& direction,
                                     const std::function<double(std::uint32_t)>& visit) const {
  double end = std::numeric_limits<double>::infinity();
  walk(origin, direction, 0, end, [&](std::uint32_t facet) { end = visit(facet); });
}

void ReferenceTracer::for_touching(const Point3& low, const Point3& high,
                                   const std::function<void(std::uint32_t)>& visit) const {
  if (node_.empty()) return;
  std::uint32_t stack[64];
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = node_[stack[--depth]];
    bool touches = true;
    for (std::size_t j = 0; j < 3; ++j)
      touches = touches && node.low[j] <= high[j] && node.high[j] >= low[j];
    if (!touches) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) visit(order_[i]);
  }
}

ReferenceTracer::Hit ReferenceTracer::nearest(const Point3& origin, const Point3& direction,
                                              double t_min, double t_max) const {
  Hit best;
  double end = t_max;
  walk_hits(origin, direction, t_min, end, [&](const Hit& hit) {
    const bool same = best.met() && std::abs(hit.t - best.t) <= kSame * std::abs(best.t);
    const bool better = !best.met()               ? true
                        : !same                   ? hit.t < best.t
                        : hit.front != best.front ? hit.front
                                                  : hit.facet < best.facet;
    if (better) best = hit;
    end = std::min(end, hit.t);
  });
  return best;
}

std::vector<ReferenceTracer::Hit> ReferenceTracer::all(const Point3& origin,
                                                       const Point3& direction, double t_min,
                                                       double t_max) const {
  std::vector<Hit> out;
  double end = t_max;
  walk_hits(origin, direction, t_min, end, [&](const Hit& hit) { out.push_back(hit); });
  return out;
}

}  // namespace irsig
