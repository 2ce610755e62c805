#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"
#include "core/scene/trace/tracer.h"

namespace irsig {

// Lost and invented hits: rays from inside a closed mesh through the ray tracer, each answer
// judged by exact arithmetic on the same float32 coordinates (hit_judge.h).

enum class AimedAt { kRandom = 0, kEdges = 1, kVertices = 2 };

struct WatertightCheck {
  AimedAt aimed_at = AimedAt::kRandom;
  std::uint64_t rays = 0;
  std::uint64_t seed = 1;
  TracerIsa isa = widest_isa();
  TracerOptions options;
  bool coherent = false;  // the tracer's flag; the rays are not
};

struct WatertightCounts {
  std::uint64_t rays = 0;
  std::uint64_t lost = 0;      // a facet is met, and the tracer reports none or a farther one
  std::uint64_t invented = 0;  // the tracer reports a facet that is not met, or none is that near
  std::uint64_t shadow_lost = 0, shadow_invented = 0;  // of occluded(), likewise
  // Answers that are not exact, but right for the ray moved sideways by at most tolerance_m; they
  // count neither as lost nor as invented.
  std::uint64_t within_tolerance = 0;
  double tolerance_m = 0;  // 2^-20 of the mesh's radius
  VertexCounts near_vertices;
  std::string first_failure;  // its origin, direction and both answers
  [[nodiscard]] std::uint64_t failures() const {
    return lost + invented + shadow_lost + shadow_invented;
  }
};

// Checks that rays cannot leave a mesh, which must enclose a volume. Rays start at 1024 points
// inside it, found by crossing numbers. Each ray is traced to its nearest hit. It is traced again
// as a shadow ray over 0.999 and 1.001 of the true distance, which must be free and blocked. Costs
// about 3 us per ray.
[[nodiscard]] absl::StatusOr<WatertightCounts> check_watertight(const Mesh& mesh,
                                                                const WatertightCheck& check);

// Returns the mesh after it was written to a text file with coordinates offset_m away from the
// origin in all three axes, and re-centred on import.
[[nodiscard]] absl::StatusOr<Mesh> import_from_offset(const Mesh& mesh, double offset_m);

struct NamedMesh {
  std::string name;
  Mesh mesh;
};
// Returns closed meshes that are difficult for ray tracers:
//   - a sphere whose poles are 2000 needles each
//   - a lens of 1 m radius and 1 mm height
//   - a spindle with facets 10^4 times longer than wide
//   - a box of twelve facets
//   - the frigate (about `frigate_triangles` facets)
[[nodiscard]] std::vector<NamedMesh> hard_closed_meshes(std::uint64_t frigate_triangles);

}  // namespace irsig
