#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/scene/trace/exact_facet.h"

namespace irsig {

// The nearest facet on a ray by exact arithmetic (exact_facet.h): what the ray tracer is checked
// against. Coordinates in double, anywhere. About 2 us a ray on 200 000 facets; immutable after
// construction, any number of threads may ask.
class ReferenceTracer {
 public:
  // triangle: three indices each.
  ReferenceTracer(std::vector<Point3> vertex, std::vector<std::uint32_t> triangle);

  static constexpr std::uint32_t kMiss = 0xffffffffu;
  struct Hit {
    std::uint32_t facet = kMiss;
    bool front = false;
    double t = 0;
    [[nodiscard]] bool met() const { return facet != kMiss; }
  };
  // Returns the nearest hit. Where t is equal to 1e-14 (a silhouette's edge) the front comes first,
  // then the lower facet number.
  [[nodiscard]] Hit nearest(const Point3& origin, const Point3& direction, double t_min,
                            double t_max) const;
  // Returns every facet that the ray meets, in no order.
  [[nodiscard]] std::vector<Hit> all(const Point3& origin, const Point3& direction, double t_min,
                                     double t_max) const;

  // Calls visit(facet) for every facet whose leaf the ray meets before the distance that visit
  // returned last, nearest leaves first: the same search with a test of the caller's.
  void for_candidates(const Point3& origin, const Point3& direction,
                      const std::function<double(std::uint32_t)>& visit) const;
  // Calls visit(facet) for every facet whose leaf touches the box.
  void for_touching(const Point3& low, const Point3& high,
                    const std::function<void(std::uint32_t)>& visit) const;

 private:
  struct Node {
    Point3 low, high;
    std::uint32_t first;  // leaf: into order_; else the left child, the right one follows it
    std::uint32_t count;  // 0: inner
  };
  template <typename Visit>
  void walk(const Point3& origin, const Point3& direction, double t_min, double& t_max,
            Visit&& visit) const;
  template <typename Visit>
  void walk_hits(const Point3& origin, const Point3& direction, double t_min, double& t_max,
                 Visit&& visit) const;
  void split(std::uint32_t node, std::vector<Point3>& centre);
  [[nodiscard]] FacetHit test(std::uint32_t facet, const Point3& origin,
                              const Point3& direction) const;

  std::vector<Point3> vertex_;
  std::vector<std::uint32_t> triangle_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> node_;
};

}  // namespace irsig
