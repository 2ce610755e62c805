#include "core/thermal/scene/sun_visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/sobol.h"

namespace irsig {

void sun_visibility(const Target& target, const ThermalFaces& faces, const SunDisk& sun,
                    const SunSettings& settings, std::span<float> out) {
  std::fill(out.begin(), out.end(), 0.0f);
  if (sun.direction.z >= 0) return;
  const Vec<Body> beside = normalized(cross(
      sun.direction, std::abs(sun.direction.x) < 0.7 ? Vec<Body>{1, 0, 0} : Vec<Body>{0, 1, 0}));
  const Vec<Body> above = cross(sun.direction, beside);
  RayPacket packet{};
  std::array<std::uint32_t, RayPacket::kSize> face_of{};
  int count = 0;
  const float share = 1.0f / static_cast<float>(settings.points);
  const auto cosine = [&](std::uint32_t face) {
    const FaceNormal n = normal_of(target, faces, face);
    return static_cast<float>(static_cast<double>(n.x) * sun.direction.x +
                              static_cast<double>(n.y) * sun.direction.y +
                              static_cast<double>(n.z) * sun.direction.z);
  };
  const auto trace = [&] {
    if (count == 0) return;
    for (int lane = count; lane < RayPacket::kSize; ++lane) packet.tfar[lane] = -1;
    target.tracer->occluded(packet, count, true);
    for (int lane = 0; lane < count; ++lane)
      if (packet.tfar[lane] >= 0) {
        const std::uint32_t face = face_of[static_cast<std::size_t>(lane)];
        out[face] += share * cosine(face);
      }
    count = 0;
  };
  for (std::uint32_t face = 0; face < faces.size(); ++face) {
    const float cos_sun = cosine(face);
    if (cos_sun <= 0 || faces.area_m2[face] <= 0 || faces.centroid_z_m[face] > settings.surface_z_m)
      continue;
    if (target.convex) {
      out[face] = cos_sun;
      continue;
    }
    const std::uint64_t seed = mix64(settings.seed ^ mix64(face + 1ULL));
    const SeedPair place = seed_pair(seed, 0), disk = seed_pair(seed, 1);
    for (std::uint32_t i = 0; i < settings.points; ++i) {
      const SamplePair at = sobol_pair(i, place), on_disk = sobol_pair_shuffled(i, disk);
      const FacePoint from = point_of(target, faces, face, at.x, at.y);
      const double radius = sun.angular_radius_rad * std::sqrt(static_cast<double>(on_disk.x)),
                   angle = 2 * std::numbers::pi * static_cast<double>(on_disk.y);
      const Vec<Body> to =
          sun.direction + radius * std::cos(angle) * beside + radius * std::sin(angle) * above;
      packet.org_x[count] = from.x;
      packet.org_y[count] = from.y;
      packet.org_z[count] = from.z;
      packet.dir_x[count] = static_cast<float>(to.x);
      packet.dir_y[count] = static_cast<float>(to.y);
      packet.dir_z[count] = static_cast<float>(to.z);
      packet.tnear[count] = packet.time[count] = 0;
      packet.tfar[count] = std::numeric_limits<float>::infinity();
      packet.mask[count] = 0xffffffffu;
      packet.flags[count] = 0;
      face_of[static_cast<std::size_t>(count)] = face;
      if (++count == RayPacket::kSize) trace();
    }
  }
  trace();
}

}  // namespace irsig
