#include "core/signature/view/seen_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/sobol.h"

namespace irsig {
namespace {

constexpr std::uint32_t kRays = 1024;  // of each stratum
constexpr double kFewestRays = 16;
constexpr double kDeepest = 0.05;  // of the range: the air's change is linear to 2 % between ends

// Sums over rays of how near and how high the light leaves, each from 0 to 1.
struct Sums {
  double rays = 0, weight = 0;
  std::array<double, 2> at{}, square{};  // near, high

  void add(double w, double near, double high) {
    if (!(w > 0)) return;
    const std::array<double, 2> place = {near, high};
    rays += 1;
    weight += w;
    for (std::size_t i = 0; i < 2; ++i) {
      at[i] += w * place[i];
      square[i] += w * place[i] * place[i];
    }
  }

  // widened: by the standard deviation of the places.
  [[nodiscard]] MeanPlace mean(bool widened) const {
    if (rays < kFewestRays) return {};
    const auto interval = [&](std::size_t i) {
      const double mean = at[i] / weight,
                   deviation = std::sqrt(std::max(0.0, square[i] / weight - mean * mean)),
                   by = (widened ? 1 : 0) * deviation + 3 * deviation / std::sqrt(rays);
      return MeanPlace::Interval{std::clamp(mean - by, 0.0, 1.0), std::clamp(mean + by, 0.0, 1.0)};
    };
    return {interval(0), interval(1)};
  }
};

}  // namespace

std::array<Environment::Line::End, 3> target_ends(const Target& target, Vec<Body> sensor) {
  Environment::Line::End near{INFINITY, -INFINITY}, far{0, INFINITY};
  for (std::size_t i = 0; i + 2 < target.vertex.size(); i += 3) {
    const Vec<Body> at = target.centre + Vec<Body>{static_cast<double>(target.vertex[i]),
                                                   static_cast<double>(target.vertex[i + 1]),
                                                   static_cast<double>(target.vertex[i + 2])};
    const double range_m = length(sensor - at);
    near = {std::min(near.range_m, range_m), std::max(near.height_m, -at.z)};
    far = {std::max(far.range_m, range_m), std::min(far.height_m, -at.z)};
  }
  return {near, {near.range_m, far.height_m}, far};
}

SeenPlaces::SeenPlaces(const Target& target, std::span<const Material> material,
                       const AimedView& view, const Emitters& emitters,
                       const std::optional<Plane>& plane)
    : emitted_(emitters.count(target.part.size())) {
  const ViewFrame& frame = view.frame;
  const auto [near, below, far] = target_ends(target, frame.sensor + target.centre);
  const double deep_m = far.range_m - near.range_m, tall_m = near.height_m - far.height_m;
  if (!(deep_m < kDeepest * near.range_m)) return;
  // Without an extent there is nothing that the air could change by.
  const auto share = [](double from_m, double of_m) { return of_m > 0 ? from_m / of_m : 0.0; };
  std::vector<Sums> of_emitter(emitted_.size());
  Sums emission, reflection;

  struct Sent {
    Vec<Body> from, direction;
  };
  RayPacket packet{};
  std::array<Sent, RayPacket::kSize> sent;
  const auto arrive = [&](int count, std::uint32_t stratum, double area_m2) {
    target.tracer->intersect(packet, count, true);
    for (int lane = 0; lane < count; ++lane) {
      const std::uint32_t f = packet.triangle[lane];
      if (f == RayPacket::kMiss) continue;
      const Target::Facet& facet = target.facet[f];
      if (view.stratum_of(f, facet.part) != stratum) continue;
      const Sent& ray = sent[static_cast<std::size_t>(lane)];
      const Vec<Body> at = ray.from + static_cast<double>(packet.tfar[lane]) * ray.direction;
      if (plane && at.z > plane->z_m) continue;
      double cosine = -dot(Vec<Body>{static_cast<double>(facet.nx), static_cast<double>(facet.ny),
                                     static_cast<double>(facet.nz)},
                           ray.direction);
      if (target.part[facet.part].two_sided) cosine = std::abs(cosine);
      if (!(cosine > 0)) continue;
      const double nearer = share(far.range_m - length(frame.sensor - at), deep_m),
                   higher = share(-(at.z + target.centre.z) - far.height_m, tall_m);
      const Material::EmissivityAndDhr surface =
          material[target.part[facet.part].material].emissivity_and_dhr(
              static_cast<float>(std::min(cosine, 1.0)));
      const double emitted = area_m2 * static_cast<double>(surface.emissivity);
      of_emitter[emitters.of(f, facet.part)].add(emitted, nearer, higher);
      emission.add(emitted, nearer, higher);
      reflection.add(area_m2 * static_cast<double>(surface.dhr_max), nearer, higher);
    }
  };
  for (std::uint32_t stratum = 0; stratum < view.stratum.size(); ++stratum) {
    const CoverageMask& mask = view.stratum[stratum];
    if (mask.empty()) continue;
    const SeedPair seed = seed_pair(mix64(stratum + 1ULL), 0);
    for (std::uint32_t i = 0; i < kRays; i += RayPacket::kSize) {
      for (std::uint32_t lane = 0; lane < RayPacket::kSize; ++lane) {
        const CoverageMask::Point p = mask.map(sobol_pair(i + lane, seed));
        const Vec<Body> on_plane = frame.plane_m * frame.forward +
                                   static_cast<double>(p.x_m) * frame.right +
                                   static_cast<double>(p.y_m) * frame.up;
        const Sent& ray = sent[lane] = {frame.sensor + on_plane, normalized(on_plane)};
        packet.org_x[lane] = static_cast<float>(ray.from.x);
        packet.org_y[lane] = static_cast<float>(ray.from.y);
        packet.org_z[lane] = static_cast<float>(ray.from.z);
        packet.dir_x[lane] = static_cast<float>(ray.direction.x);
        packet.dir_y[lane] = static_cast<float>(ray.direction.y);
        packet.dir_z[lane] = static_cast<float>(ray.direction.z);
        packet.tnear[lane] = packet.time[lane] = 0;
        packet.tfar[lane] = std::numeric_limits<float>::infinity();
        packet.mask[lane] = 0xffffffffu;
        packet.flags[lane] = 0;
        packet.triangle[lane] = RayPacket::kMiss;
        packet.geometry[lane] = packet.instance[lane] = RayPacket::kMiss;
      }
      arrive(RayPacket::kSize, stratum, mask.area_m2());
    }
  }
  for (std::size_t e = 0; e < emitted_.size(); ++e) emitted_[e] = of_emitter[e].mean(false);
  any_emitted_ = emission.mean(true);
  reflected_ = reflection.mean(true);
}

}  // namespace irsig
