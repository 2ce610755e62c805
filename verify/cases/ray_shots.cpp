#include "verify/cases/ray_shots.h"

namespace irsig {

double distance_from_plane_m(const Target& target, std::uint32_t triangle, Float3 p) {
  const auto corner = [&](int k) {
    const float* v =
        target.vertex.data() + 3 * target.triangle[3 * triangle + static_cast<std::uint32_t>(k)];
    return Vec<Body>{v[0], v[1], v[2]};
  };
  const Vec<Body> a = corner(0);
  const Vec<Body> normal = normalized(cross(corner(1) - a, corner(2) - a));
  return std::abs(dot(Vec<Body>{p.x, p.y, p.z} - a, normal));
}

}  // namespace irsig
