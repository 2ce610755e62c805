#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/scene/trace/tracer.h"

namespace irsig {

struct Float3 {
  float x, y, z;
};
inline float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// The state that a path carries from vertex to vertex.
struct PathState {
  std::uint32_t replicate;
  std::uint32_t sample;       // index in the sampler
  std::uint32_t pixel_group;  // in Work::group_sum
  std::uint32_t first;  // the part that was met first; behind hot gas: 2 x its primary ray's place
                        // in Work::gas_fraction, + 1 beyond the target; that came through hot gas
                        // to the target: parts + its place there
  float weight;  // Jacobian x throughput / survival probabilities (spectral: without the spectral
                 // factor)
  float throughput;    // weight without the Jacobian: what the roulette is played with ...
  float spectral_max;  // ... times the largest of the path's spectral factors. Of a ray to the sun:
                       // whether it lies in the middle of a narrow lobe
  float inverse_length;  // of the ray's direction
};

// Rays with their paths' states, in packets; spectral factors in rows of `nodes`.
struct RayBatch {
  std::vector<RayPacket> packet;
  std::vector<PathState> state;
  std::vector<float> spectrum;
  // Density of the last vertex's rays where there are hot lights, in rows of 1 + lights: the
  // expected number of rays per solid angle that the vertex drew in this direction [1/sr], and the
  // expected number that it aims at each light.
  std::vector<float> drawn;
  std::uint32_t size = 0;

  void resize(std::uint32_t capacity, std::size_t nodes, std::size_t drawn_columns = 0) {
    packet.resize((capacity + RayPacket::kSize - 1) / RayPacket::kSize);
    state.resize(capacity);
    spectrum.resize(nodes * capacity);
    drawn.resize(drawn_columns * capacity);
  }
  RayPacket& packet_of(std::uint32_t i) { return packet[i / RayPacket::kSize]; }
  static std::uint32_t lane_of(std::uint32_t i) { return i % RayPacket::kSize; }

  std::uint32_t push(Float3 origin, Float3 direction, const PathState& s) {
    const std::uint32_t i = size++;
    RayPacket& p = packet_of(i);
    const std::uint32_t lane = lane_of(i);
    p.org_x[lane] = origin.x;
    p.org_y[lane] = origin.y;
    p.org_z[lane] = origin.z;
    p.dir_x[lane] = direction.x;
    p.dir_y[lane] = direction.y;
    p.dir_z[lane] = direction.z;
    state[i] = s;
    return i;
  }
  // Moves a primary ray that has met its facet into the place of an earlier one.
  void move(std::uint32_t from, std::uint32_t to) {
    if (from == to) return;
    const RayPacket& a = packet_of(from);
    RayPacket& b = packet_of(to);
    const std::uint32_t i = lane_of(from), k = lane_of(to);
    b.org_x[k] = a.org_x[i];
    b.org_y[k] = a.org_y[i];
    b.org_z[k] = a.org_z[i];
    b.dir_x[k] = a.dir_x[i];
    b.dir_y[k] = a.dir_y[i];
    b.dir_z[k] = a.dir_z[i];
    b.tfar[k] = a.tfar[i];
    b.u[k] = a.u[i];
    b.v[k] = a.v[i];
    b.triangle[k] = a.triangle[i];
    b.geometry[k] = a.geometry[i];
    state[to] = state[from];
  }
  // Fields that every ray shares; `hits`: also those that a nearest-hit query wants. tfar: the ends
  // of the rays in units of their directions.
  void prepare_packets(bool hits, float tfar = std::numeric_limits<float>::infinity()) {
    for (std::uint32_t k = 0; k * RayPacket::kSize < size; ++k) {
      RayPacket& p = packet[k];
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        p.tnear[lane] = 0;
        p.time[lane] = 0;
        p.tfar[lane] = tfar;
        p.mask[lane] = 0xffffffffu;
        p.flags[lane] = 0;
      }
      if (!hits) continue;
      for (int lane = 0; lane < RayPacket::kSize; ++lane)
        p.triangle[lane] = p.geometry[lane] = p.instance[lane] = RayPacket::kMiss;
    }
  }
  template <typename Trace>
  void for_each_packet(Trace&& trace) {
    for (std::uint32_t first = 0; first < size; first += RayPacket::kSize)
      trace(packet[first / RayPacket::kSize],
            static_cast<int>(std::min<std::uint32_t>(RayPacket::kSize, size - first)));
  }
};

}  // namespace irsig
