#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/scene/trace/target.h"
#include "core/transport/ray_batch.h"

namespace irsig {

// One ray as the tracer receives it, and its hit.
struct Shot {
  Float3 origin, direction;  // relative to the target's centre [m]
  bool hit = false;
  float distance = 0;  // in lengths of direction
  std::uint32_t triangle = 0;

  [[nodiscard]] Float3 point() const {  // as the path tracer computes it
    return {origin.x + distance * direction.x, origin.y + distance * direction.y,
            origin.z + distance * direction.z};
  }
};

// Traces `count` rays in full packets: aim(i, shot) sets origin and direction of ray i, see(i,
// shot) receives its hit. sheet_m: if not below 0, only the front of the body is hit, as by paths
// on one-sided parts.
template <typename Aim, typename See>
void shoot(const Tracer& tracer, std::uint64_t count, bool coherent, Aim&& aim, See&& see,
           float sheet_m = -1) {
  RayBatch batch;
  batch.resize(RayPacket::kSize, 0);
  for (std::uint64_t first = 0; first < count; first += RayPacket::kSize) {
    const auto n =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(RayPacket::kSize, count - first));
    Shot shot[RayPacket::kSize];
    batch.size = 0;
    for (std::uint32_t lane = 0; lane < n; ++lane) {
      aim(first + lane, shot[lane]);
      batch.push(shot[lane].origin, shot[lane].direction, {});
    }
    batch.prepare_packets(true);
    RayPacket& packet = batch.packet.front();
    tracer.intersect(packet, static_cast<int>(n), coherent);
    for (std::uint32_t lane = 0; lane < n; ++lane) {
      const Float3 normal{packet.normal_x[lane], packet.normal_y[lane], packet.normal_z[lane]};
      if (sheet_m >= 0 && packet.triangle[lane] != RayPacket::kMiss &&
          dot(normal, shot[lane].direction) >= 0)
        tracer.look_for_front(packet, static_cast<int>(lane), sheet_m);
      shot[lane].triangle = packet.triangle[lane];
      shot[lane].hit = packet.triangle[lane] != RayPacket::kMiss;
      shot[lane].distance = packet.tfar[lane];
      see(first + lane, shot[lane]);
    }
  }
}

// Tests each ray for obstacles, as shadow rays do: see(i, blocked).
template <typename Aim, typename See>
void shoot_shadows(const Tracer& tracer, std::uint64_t count, bool coherent, Aim&& aim, See&& see) {
  RayBatch batch;
  batch.resize(RayPacket::kSize, 0);
  for (std::uint64_t first = 0; first < count; first += RayPacket::kSize) {
    const auto n =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(RayPacket::kSize, count - first));
    batch.size = 0;
    for (std::uint32_t lane = 0; lane < n; ++lane) {
      Shot shot;
      aim(first + lane, shot);
      batch.push(shot.origin, shot.direction, {});
    }
    batch.prepare_packets(false);
    RayPacket& packet = batch.packet.front();
    tracer.occluded(packet, static_cast<int>(n), coherent);
    for (std::uint32_t lane = 0; lane < n; ++lane) see(first + lane, packet.tfar[lane] < 0);
  }
}

inline Float3 to_float3(Vec<Body> v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Returns the distance of a point from the plane of a facet, by the tracer's float vertices.   [m]
[[nodiscard]] double distance_from_plane_m(const Target& target, std::uint32_t triangle, Float3 p);

}  // namespace irsig
