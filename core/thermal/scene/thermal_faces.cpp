#include "core/thermal/scene/thermal_faces.h"

#include <array>
#include <cmath>

namespace irsig {
namespace {

std::array<const float*, 3> corners(const Target& target, std::uint32_t facet) {
  const std::uint32_t* index = target.triangle.data() + 3 * static_cast<std::size_t>(facet);
  const float* vertex = target.vertex.data();
  return {vertex + 3 * static_cast<std::size_t>(index[0]),
          vertex + 3 * static_cast<std::size_t>(index[1]),
          vertex + 3 * static_cast<std::size_t>(index[2])};
}

}  // namespace

ThermalFaces make_thermal_faces(const Target& target) {
  ThermalFaces out;
  out.fronts = target.facet.size();
  const auto facets = static_cast<std::uint32_t>(out.fronts);
  for (std::uint32_t f = 0; f < facets; ++f) {
    const auto [a, b, c] = corners(target, f);
    const Vec<Body> ab{static_cast<double>(b[0] - a[0]), static_cast<double>(b[1] - a[1]),
                       static_cast<double>(b[2] - a[2])};
    const Vec<Body> ac{static_cast<double>(c[0] - a[0]), static_cast<double>(c[1] - a[1]),
                       static_cast<double>(c[2] - a[2])};
    const Target::Facet& facet = target.facet[f];
    const bool degenerate = facet.nx == 0 && facet.ny == 0 && facet.nz == 0;
    out.facet.push_back(f);
    out.area_m2.push_back(degenerate ? 0 : 0.5 * length(cross(ab, ac)));
    out.centroid_z_m.push_back(
        target.centre.z +
        (static_cast<double>(a[2]) + static_cast<double>(b[2]) + static_cast<double>(c[2])) / 3);
  }
  out.back_of_facet.assign(out.fronts, ThermalFaces::kNone);
  for (std::uint32_t f = 0; f < facets; ++f) {
    if (!target.part[target.facet[f].part].two_sided) continue;
    out.back_of_facet[f] = static_cast<std::uint32_t>(out.size());
    out.facet.push_back(f);
    out.area_m2.push_back(out.area_m2[f]);
    out.centroid_z_m.push_back(out.centroid_z_m[f]);
  }
  return out;
}

FacePoint point_of(const Target& target, const ThermalFaces& faces, std::uint32_t face, float u,
                   float v) {
  const auto [a, b, c] = corners(target, faces.facet[face]);
  const float root = std::sqrt(u);
  const float of_a = 1 - root, of_b = root * (1 - v), of_c = root * v;
  const auto off = static_cast<float>(target.offset_m());
  const FaceNormal n = normal_of(target, faces, face);
  return {of_a * a[0] + of_b * b[0] + of_c * c[0] + off * n.x,
          of_a * a[1] + of_b * b[1] + of_c * c[1] + off * n.y,
          of_a * a[2] + of_b * b[2] + of_c * c[2] + off * n.z};
}

}  // namespace irsig
