#include "live/own_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geo/frames.h"
#include "live/ray_lane.h"

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

Vec<Body> middle_of(const Target& target, std::uint32_t f) {
  Vec<Body> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float* v = target.vertex.data() + std::size_t{3} * target.triangle[3 * f + k];
    out = out + (1.0 / 3) * Vec<Body>{v[0], v[1], v[2]};
  }
  return out;
}

Vec<Body> normal_of(const Target& target, std::uint32_t f) {
  return {target.facet[f].nx, target.facet[f].ny, target.facet[f].nz};
}

struct SentSunlight {
  float radiance = 0;        // per unit irradiance of the sun; 0 in shade [1/sr]
  bool from_behind = false;  // the side that faces the sun is that behind the facet
};
// Returns what the side of each facet that faces the sun sends.
std::vector<SentSunlight> sent_sunlight(const Target& target, Vec<Body> sun,
                                        const OwnParts::Reflectance& reflectance) {
  std::vector<SentSunlight> out(target.facet.size());
  RayPacket packet{};
  std::uint32_t of[RayPacket::kSize];
  int count = 0;
  const auto follow = [&] {
    if (count == 0) return;
    target.tracer->occluded(packet, count, false);
    for (int k = 0; k < count; ++k)
      if (packet.tfar[k] < 0) out[of[k]].radiance = 0;
    count = 0;
  };
  for (std::uint32_t f = 0; f < target.facet.size(); ++f) {
    const auto& part = target.part[target.facet[f].part];
    Vec<Body> n = normal_of(target, f);
    double cosine = dot(n, sun);
    if (cosine < 0 && part.two_sided) {
      n = -1.0 * n;
      cosine = -cosine;
      out[f].from_behind = true;
    }
    if (!(cosine > 0)) continue;
    out[f].radiance = reflectance(part.material, static_cast<float>(cosine)) *
                      static_cast<float>(cosine / std::numbers::pi);
    set_ray(packet, count, middle_of(target, f) + target.offset_m() * n, sun);
    of[count++] = f;
    if (count == RayPacket::kSize) follow();
  }
  follow();
  return out;
}

}  // namespace

OwnParts OwnParts::make(const Target& target, const Emitters* emitters) {
  OwnParts out;
  if (target.convex) return out;
  const auto directions = cosine_directions();
  out.facet.resize(target.facet.size());
  RayPacket packet{};
  for (std::uint32_t f = 0; f < target.facet.size(); ++f) {
    const Vec<Body> n = normal_of(target, f);
    out.first_met.push_back(static_cast<std::uint32_t>(out.met.size()));
    if (!(length(n) > 0.5)) continue;
    const Vec<Body> middle = middle_of(target, f);
    const Vec<Body> x = normalized(std::abs(n.z) < 0.9 ? cross(n, Vec<Body>{0, 0, 1})
                                                       : cross(n, Vec<Body>{1, 0, 0})),
                    y = cross(n, x), from = middle + target.offset_m() * n;
    std::array<std::uint32_t, kRays> met{};
    std::size_t hits = 0;
    for (int first = 0; first < kRays; first += RayPacket::kSize) {
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const Vec<Body>& d = directions[static_cast<std::size_t>(first + lane)];
        set_ray(packet, lane, from, d.x * x + d.y * y + d.z * n);
      }
      target.tracer->intersect(packet, RayPacket::kSize, false);
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const std::uint32_t triangle = packet.triangle[lane];
        if (triangle == RayPacket::kMiss) continue;
        const Vec<Body> d{packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]};
        out.met.push_back({triangle, dot(normal_of(target, triangle), d) > 0});
        const std::uint32_t part = target.facet[triangle].part;
        met[hits++] = emitters != nullptr ? emitters->of(triangle, part) : part;
      }
    }
    if (hits == 0) continue;
    // The middle of the sorted list is met by most, if any is met by more than half.
    std::sort(met.begin(), met.begin() + static_cast<std::ptrdiff_t>(hits));
    out.facet[f] = {static_cast<float>(hits) / kRays, met[hits / 2]};
  }
  out.first_met.push_back(static_cast<std::uint32_t>(out.met.size()));
  return out;
}

std::vector<float> OwnParts::sunlight(const Target& target, Vec<Body> sun,
                                      const Reflectance& reflectance) const {
  std::vector<float> out(facet.size(), 0.0f);
  if (facet.empty()) return out;
  const std::vector<SentSunlight> sent = sent_sunlight(target, sun, reflectance);
  for (std::size_t f = 0; f < facet.size(); ++f) {
    for (std::uint32_t k = first_met[f]; k < first_met[f + 1]; ++k)
      if (sent[met[k].facet].from_behind == met[k].from_behind)
        out[f] += sent[met[k].facet].radiance;
    out[f] /= kRays;
  }
  return out;
}

}  // namespace irsig
