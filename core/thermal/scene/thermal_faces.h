#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/scene/trace/target.h"

namespace irsig {

// The faces of a target that exchange heat: the front of each facet, then the backs of those that
// are seen from both sides.
struct ThermalFaces {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<std::uint32_t> facet;          // [face]; of the first ones: the face itself
  std::vector<std::uint32_t> back_of_facet;  // [facet] a face; kNone: it has no back
  std::vector<double> area_m2;               // [face]; 0: a degenerate facet, which takes no part
  std::vector<double> centroid_z_m;          // [face] in the body frame: down
  std::size_t fronts = 0;                    // = facets

  [[nodiscard]] std::size_t size() const { return facet.size(); }
  [[nodiscard]] bool is_back(std::uint32_t face) const { return face >= fronts; }
};

[[nodiscard]] ThermalFaces make_thermal_faces(const Target& target);

// Unit normal, outwards of this face.
struct FaceNormal {
  float x, y, z;
};
[[nodiscard]] inline FaceNormal normal_of(const Target& target, const ThermalFaces& faces,
                                          std::uint32_t face) {
  const Target::Facet& f = target.facet[faces.facet[face]];
  return faces.is_back(face) ? FaceNormal{-f.nx, -f.ny, -f.nz} : FaceNormal{f.nx, f.ny, f.nz};
}

// A point of a face, uniform over it for u, v uniform in (0, 1), off it by the target's offset_m()
// to the face's side. x, y, z as in Target.
struct FacePoint {
  float x, y, z;
};
[[nodiscard]] FacePoint point_of(const Target& target, const ThermalFaces& faces,
                                 std::uint32_t face, float u, float v);

}  // namespace irsig
