#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/trace/target.h"
#include "core/transport/ray_batch.h"

namespace irsig {

// The hot parts as light sources: at each vertex of a path a point of theirs is aimed at, so that a
// small bright part is not left to the luck of drawn directions.
//
// Their triangles are gathered into at most kMostLights compact groups (lights), each cut into
// clusters of triangles that lie close together and face the same way. Which light: by a bound on
// what it can contribute (vector_stages.h, hot_rate). Within it a cluster is chosen by area / (its
// distance)^2 times the largest cosine under which it can be seen - a cluster that certainly faces
// away is never chosen -, a triangle by its area, and a point uniformly on it.
class HotLights {
 public:
  static constexpr std::uint32_t kMostLights = 8;
  static constexpr std::uint32_t kMostClusters = 16;  // of one light
  static constexpr std::uint32_t kNone = 0xffffffffu;

  HotLights() = default;  // no lights
  explicit HotLights(const Target& target);

  struct Sphere {
    Float3 centre;
    float radius;
    float area_m2;  // of the triangles, both sides where they shine from both
  };
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(light_.size()); }
  [[nodiscard]] const Sphere& bounds(std::uint32_t light) const { return light_[light].sphere; }
  // Returns the light of a facet; kNone: the facet is not hot.
  [[nodiscard]] std::uint32_t light_of(std::uint32_t facet) const {
    const std::uint32_t i = facet - first_facet_;  // wraps around for facets before the first
    return i >= cluster_of_.size() || cluster_of_[i] == kNone ? kNone
                                                              : cluster_[cluster_of_[i]].light;
  }

  struct Point {
    std::uint32_t facet = 0;
    Float3 at;             // off the facet, on the side of x
    Float3 direction;      // unit vector from x
    float cos_l = 0;       // at the light; <= 0: the point does not shine towards x
    float density_per_sr;  // of this direction, seen from x
  };
  // Chooses a point of a light as seen from x. u_cluster, u_triangle, u, v: in (0, 1).
  [[nodiscard]] Point choose(std::uint32_t light, Float3 x, float u_cluster, float u_triangle,
                             float u, float v) const;
  // Returns the density with which choose() takes the direction of a point of a hot facet at this
  // distance and cosine. [1/sr]
  [[nodiscard]] float density_per_sr(std::uint32_t facet, Float3 x, float distance2,
                                     float cos_l) const;

 private:
  struct Cluster {
    std::uint32_t light;
    std::uint32_t first, last;         // in triangle_
    Float3 centre, axis;               // axis: mean normal; all normals lie within a cone about it
    float radius, cos_half, sin_half;  // of the bounding sphere; of that cone's half angle
    bool two_sided;
    float area_m2;
  };
  struct Light {
    Sphere sphere;
    std::uint32_t first, last;  // in cluster_
  };
  [[nodiscard]] float share(const Cluster& cluster, Float3 x) const;
  void add_light(std::vector<std::uint32_t> facets);
  [[nodiscard]] Cluster make_cluster(const std::vector<std::uint32_t>& facets);
  [[nodiscard]] Float3 corner(std::uint32_t facet, int k) const;
  [[nodiscard]] Float3 centroid(std::uint32_t facet) const;
  [[nodiscard]] float area_m2(std::uint32_t facet) const;

  const Target* target_ = nullptr;
  std::vector<Light> light_;
  std::vector<Cluster> cluster_;
  std::vector<std::uint32_t> triangle_;    // facets, cluster by cluster
  std::vector<float> area_up_to_;          // running share of the cluster's area, up to 1
  std::uint32_t first_facet_ = 0;          // the first hot one
  std::vector<std::uint32_t> cluster_of_;  // of each facet from there to the last hot one
};

}  // namespace irsig
