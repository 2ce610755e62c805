#include "live/own_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geo/frames.h"

namespace irsig {
namespace {

// Directions of a hemisphere around z, with a density in proportion to the cosine.
std::array<Vec<Body>, OwnParts::kRays> cosine_directions() {
  std::array<Vec<Body>, OwnParts::kRays> out;
  for (int k = 0; k < OwnParts::kRays; ++k) {
    const double u = (k + 0.5) / OwnParts::kRays, phi = k * std::numbers::pi * (3 - std::sqrt(5.0)),
                 r = std::sqrt(u);
    out[static_cast<std::size_t>(k)] = {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u)};
  }
  return out;
}

void begin_ray(Vec<Body> from, Vec<Body> d, int lane, RayPacket& packet) {
  packet.org_x[lane] = static_cast<float>(from.x);
  packet.org_y[lane] = static_cast<float>(from.y);
  packet.org_z[lane] = static_cast<float>(from.z);
  packet.dir_x[lane] = static_cast<float>(d.x);
  packet.dir_y[lane] = static_cast<float>(d.y);
  packet.dir_z[lane] = static_cast<float>(d.z);
  packet.tnear[lane] = packet.time[lane] = 0;
  packet.tfar[lane] = std::numeric_limits<float>::infinity();
  packet.mask[lane] = 0xffffffffu;
  packet.id[lane] = static_cast<std::uint32_t>(lane);
  packet.flags[lane] = 0;
  packet.triangle[lane] = packet.geometry[lane] = packet.instance[lane] = RayPacket::kMiss;
}

}  // namespace

OwnParts OwnParts::make(const Target& target, const Emitters* emitters) {
  OwnParts out;
  if (target.convex) return out;
  const auto directions = cosine_directions();
  out.facet.resize(target.facet.size());
  RayPacket packet{};
  for (std::uint32_t f = 0; f < target.facet.size(); ++f) {
    const Target::Facet& of = target.facet[f];
    const Vec<Body> n{of.nx, of.ny, of.nz};
    if (!(length(n) > 0.5)) continue;
    Vec<Body> middle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const float* v = target.vertex.data() + std::size_t{3} * target.triangle[3 * f + k];
      middle = middle + (1.0 / 3) * Vec<Body>{v[0], v[1], v[2]};
    }
    const Vec<Body> x = normalized(std::abs(n.z) < 0.9 ? cross(n, Vec<Body>{0, 0, 1})
                                                       : cross(n, Vec<Body>{1, 0, 0})),
                    y = cross(n, x), from = middle + target.offset_m() * n;
    std::array<std::uint32_t, kRays> met{};
    std::size_t hits = 0;
    for (int first = 0; first < kRays; first += RayPacket::kSize) {
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const Vec<Body>& d = directions[static_cast<std::size_t>(first + lane)];
        begin_ray(from, d.x * x + d.y * y + d.z * n, lane, packet);
      }
      target.tracer->intersect(packet, RayPacket::kSize, false);
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const std::uint32_t triangle = packet.triangle[lane];
        if (triangle == RayPacket::kMiss) continue;
        const std::uint32_t part = target.facet[triangle].part;
        met[hits++] = emitters != nullptr ? emitters->of(triangle, part) : part;
      }
    }
    if (hits == 0) continue;
    // The middle of the sorted list is met by most, if any is met by more than half.
    std::sort(met.begin(), met.begin() + static_cast<std::ptrdiff_t>(hits));
    out.facet[f] = {static_cast<float>(hits) / kRays, met[hits / 2]};
  }
  return out;
}

}  // namespace irsig
