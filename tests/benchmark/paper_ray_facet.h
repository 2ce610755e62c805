#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/trace/reference_tracer.h"

namespace irsig {

// The ray-facet tests of the ship paper, as it states them, in float or double, on coordinates as
// they lie in the file:
//   RTM   the point P where the ray meets the facet's plane; inside where for all corners
//         (r_i x r_i+1) . n >= 0, r_i from P to corner i
//   IRTM  (r_i x r_i+1) . d <= 0 (>= 0 from behind) for all corners, r_i from the ray's origin to
//         corner i, d its direction: P is computed only for the distance
// A scene is searched facet by facet; so that 200 000 facets can be asked, the candidates come from
// a tree of boxes, in double and on the same rounded coordinates, so that it loses nothing.
enum class PaperTest { kRtm, kIrtm };

template <typename Real>
class PaperTracer {
 public:
  // vertex: x y z relative to the mesh's centre; the test runs offset_m away in all three axes,
  // rounded to Real.
  PaperTracer(const std::vector<float>& vertex, std::vector<std::uint32_t> triangle,
              double offset_m);

  [[nodiscard]] ReferenceTracer::Hit nearest(const Point3& origin, const Point3& direction,
                                             PaperTest test) const;

 private:
  struct Vector {
    Real x, y, z;
  };
  [[nodiscard]] double distance(std::uint32_t facet, const Vector& origin, const Vector& direction,
                                PaperTest test) const;

  double offset_m_;
  std::vector<std::uint32_t> triangle_;
  std::vector<Vector> vertex_, normal_;
  ReferenceTracer tree_;
};

extern template class PaperTracer<float>;
extern template class PaperTracer<double>;

}  // namespace irsig
