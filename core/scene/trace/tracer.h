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
  float u[16], v[16];                              // the ray tracer's own
  std::uint32_t triangle[16], geometry[16], instance[16];
#ifdef IRSIG_EMBREE_4
  std::uint32_t instance_part[16];  // written where Embree was built with arrays of instances
#endif
};

// The instruction sets that the ray tracer may be pinned to; results can differ in the last bit
// between them.
enum class TracerIsa { kAvx512, kAvx2, kSse42 };
// Returns the widest set that this machine has and pin_isa() allows.
[[nodiscard]] TracerIsa widest_isa();
// Limits this process, from here on, to instruction sets no wider than this one ("avx512", "avx2",
// "sse4.2"): unlike machines that share a sweep are pinned to their common set. INVALID_ARGUMENT:
// an unknown name; FAILED_PRECONDITION: this machine does not have it.
[[nodiscard]] absl::Status pin_isa(const std::string& name);
[[nodiscard]] std::string isa_name(TracerIsa isa);

// Guards beyond Embree's own ROBUST traversal. On the frigate kEdges costs 1 to 3 % of a view,
// kVertices 17 to 23 % (docs/evidence/performance.md).
enum class TracerGuard {
  kNone = 0,      // Embree alone
  kEdges = 1,     // the facet that a ray meets close to an edge is the true one
  kVertices = 2,  // and no ray is lost at a vertex
};

// The defaults are for every use but a benchmark.
struct TracerOptions {
  bool robust = true;  // Embree's ROBUST traversal: no ray is lost between two facets
  TracerGuard guard = TracerGuard::kVertices;
};

// Counts of the calls of the guard at the vertices.
struct VertexCounts {
  std::uint64_t near_vertex = 0;  // caps that rays met (vertex_fans.h)
  std::uint64_t decided = 0;      // of these: met a facet around it by exact arithmetic
};

// Ray-triangle intersection by Embree 3.13 or 4 (embree.h): float32 coordinates, which
// the caller keeps near the origin, rays that start within a few radii of it. Immutable after
// construction: any number of threads may trace. What a ray meets depends on the ray alone.
//
// No ray through a closed surface is lost: ROBUST traversal decides every edge in the same way for
// the two facets that share it, and a ray that passes a vertex within 2^-21.6 of the mesh's radius
// is decided by exact arithmetic among the facets that meet there (vertex_fans.h), and so is one
// whose hit lies close to an edge or on a needle (256 times longer than high: along its edges the
// error of a float edge test grows as the inverse sine of the angle between ray and edge). Against
// exact arithmetic an answer may differ by as much as the ray moved sideways by 2^-20 of the radius
// does (docs/evidence/validation.md, lost and invented hits).
//
// Surfaces closer to each other than distances are known (2^-22 of them): beyond 256 m a ray looks
// again from shortly before what it has met, and so meets the nearer one.
//
// Of facets with the same three corners the one that faces the ray is reported, of several that do
// the first.
class Tracer {
 public:
  // Builds a tracer. vertex: x y z; triangle: three indices.
  static absl::StatusOr<std::unique_ptr<Tracer>> build(const std::vector<float>& vertex,
                                                       const std::vector<std::uint32_t>& triangle,
                                                       TracerIsa isa, TracerOptions options = {});
  virtual ~Tracer() = default;

  // Finds the nearest hit of the first `count` rays of a packet. `coherent` rays start and go close
  // to each other.
  virtual void intersect(RayPacket& packet, int count, bool coherent) const = 0;
  // Marks the rays that meet anything between tnear and tfar.
  virtual void occluded(RayPacket& packet, int count, bool coherent) const = 0;

  // Looks for the front that a ray should have met, after a hit from behind on a surface that has
  // no back. Such a hit is an open or inverted surface, or a ray that float arithmetic let through
  // a needle, or one of two sheets that lie on each other. Exact arithmetic over the whole mesh
  // decides (2 to 5 us); where a back is the nearest all the same, a front at most `sheet_m` behind
  // it is taken. Returns false, and leaves the packet as it was, where there is neither.
  virtual bool look_for_front(RayPacket& packet, int lane, float sheet_m) const = 0;

  // Returns the counts of all threads since construction.
  [[nodiscard]] virtual VertexCounts vertex_counts() const { return {}; }
};

}  // namespace irsig
