#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Sixteen rays and what they met, in the ray tracer's own layout. A ray is inactive when its tfar <
// tnear.
struct alignas(64) RayPacket {
  static constexpr int kSize = 16;
  static constexpr std::uint32_t kMiss = 0xffffffffu;
  float org_x[16], org_y[16], org_z[16], tnear[16];
  float dir_x[16], dir_y[16], dir_z[16], time[16];
  float tfar[16];  // after occluded(): -inf where something is in the way
  std::uint32_t mask[16], id[16], flags[16];
  float normal_x[16], normal_y[16], normal_z[16];  // not normalised
  float u[16], v[16];
  std::uint32_t triangle[16], geometry[16], instance[16];
};

// The instruction sets that the ray tracer may be pinned to; results can differ in the last bit
// between them.
enum class TracerIsa { kAvx512, kAvx2, kSse42 };
[[nodiscard]] TracerIsa widest_isa();
[[nodiscard]] std::string isa_name(TracerIsa isa);

// Ray-triangle intersection by Embree 3 (this class is its only user): float32 coordinates, which
// the caller keeps near the origin; ROBUST traversal (edge-watertight). Immutable after
// construction: any number of threads may trace.
class Tracer {
 public:
  // vertex: x y z, triangle: three indices.
  static absl::StatusOr<std::unique_ptr<Tracer>> build(const std::vector<float>& vertex,
                                                       const std::vector<std::uint32_t>& triangle,
                                                       TracerIsa isa);
  virtual ~Tracer() = default;

  // Nearest hit of the first `count` rays of a packet. `coherent` rays start and go close to each
  // other.
  virtual void intersect(RayPacket& packet, int count, bool coherent) const = 0;
  // Whether anything lies between tnear and tfar.
  virtual void occluded(RayPacket& packet, int count, bool coherent) const = 0;
};

}  // namespace irsig
