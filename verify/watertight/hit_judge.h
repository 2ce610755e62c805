#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/mesh.h"
#include "core/scene/trace/reference_tracer.h"

namespace irsig {

// Judges a ray tracer's answers by exact arithmetic on the float32 coordinates that make_target()
// would give it. Any number of threads may ask.
class HitJudge {
 public:
  explicit HitJudge(const Mesh& mesh);

  struct Ray {
    Point3 origin, direction;  // relative to the centre of the mesh's box [m]
  };
  using Hit = ReferenceTracer::Hit;
  [[nodiscard]] Hit truth(const Ray& ray) const;

  enum class Verdict {
    kRight = 0,            // the same facet, or one that meets the ray within four tolerances
    kWithinTolerance = 1,  // not so, but right for the ray moved sideways by tolerance_m
    kLost = 2,             // a facet is met, and the answer is none or a farther one
    kInvented = 3,         // the answer is a facet that is not met
  };
  [[nodiscard]] Verdict judge(const Ray& ray, const Hit& truth, const Hit& answer) const;
  // Returns true if the ray, moved sideways by at most tolerance_m, has the given state (blocked or
  // free) before t_max.
  [[nodiscard]] bool blocked_nearby(const Ray& ray, double t_max, bool blocked) const;

  // Returns 2^-20 of the radius. Float32 coordinates are rounded by up to a sixteenth of that, and
  // a float32 edge test has an error of about a quarter of that from a distance of two radii.
  [[nodiscard]] double tolerance_m() const { return 0x1p-20 * radius_m_; }
  [[nodiscard]] double radius_m() const { return radius_m_; }
  [[nodiscard]] const Point3& half_size() const { return half_size_; }
  [[nodiscard]] const std::vector<float>& vertex() const { return vertex_; }  // x y z
  [[nodiscard]] const std::vector<std::uint32_t>& triangle() const { return triangle_; }
  [[nodiscard]] const ReferenceTracer& reference() const { return reference_; }

 private:
  ReferenceTracer centred(const Mesh& mesh);
  [[nodiscard]] bool same(const Hit& truth, const Hit& answer, double ray_length) const;
  [[nodiscard]] bool passes_close(const Ray& ray, std::uint32_t facet) const;
  template <typename Accept>
  [[nodiscard]] bool some_nearby(const Ray& ray, Accept&& accept) const;

  std::vector<float> vertex_;
  std::vector<std::uint32_t> triangle_;
  Point3 half_size_{};
  double radius_m_ = 0;
  ReferenceTracer reference_;
};

}  // namespace irsig
