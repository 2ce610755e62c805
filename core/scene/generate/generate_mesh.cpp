#include "core/scene/generate/generate_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/scene/generate/generate_kinds.h"
#include "core/scene/mesh_measure.h"
#include "fmt/format.h"
#include "fmt/ranges.h"

namespace irsig {
namespace {

struct Kind {
  const char* name;
  std::uint64_t min_triangles;
  double radius_m, length_m, width_m, height_m;  // defaults; 0 = the kind has no such dimension
};
constexpr Kind kinds[] = {
    {"disk", 3, 1, 0, 0, 0},
    {"sphere", 8, 1, 0, 0, 0},
    {"box", 12, 0, 2, 1, 0.5},
    {"cylinder", 12, 0.5, 3, 0, 0},
    {"cone", 6, 1, 2, 0, 0},
    {"frigate", 2000, 0, 153.8, 20.4, 6.4},
    {"cooling_tower", 416, 4, 12, 12, 10},
};
// 50 million triangles are 2.4 GB here and 4 GB in the ray tracer.
constexpr std::uint64_t max_triangles = 50'000'000;

}  // namespace

std::vector<std::string> generator_kinds() {
  std::vector<std::string> out;
  for (const Kind& k : kinds) out.emplace_back(k.name);
  return out;
}

absl::StatusOr<Mesh> generate_mesh(const MeshGenerator& what) {
  const Kind* kind = nullptr;
  for (const Kind& k : kinds)
    if (what.kind == k.name) kind = &k;
  if (kind == nullptr) {
    return absl::InvalidArgumentError(fmt::format("model \"{}\", expected one of {}", what.kind,
                                                  fmt::join(generator_kinds(), ", ")));
  }
  if (what.triangles < kind->min_triangles || what.triangles > max_triangles) {
    return absl::InvalidArgumentError(fmt::format("triangles = {}, expected {} to {} for a {}",
                                                  what.triangles, kind->min_triangles,
                                                  max_triangles, kind->name));
  }
  const auto dimension = [&](const char* key, double value, double by_default,
                             double& out) -> absl::Status {
    if (value != 0 && by_default == 0)
      return absl::InvalidArgumentError(fmt::format("a {} has no {}", kind->name, key));
    if (value < 0 || !std::isfinite(value) || (value != 0 && (value < 1e-6 || value > 1e6))) {
      return absl::InvalidArgumentError(
          fmt::format("{} = {}, expected 1e-6 to 1e6 metres", key, value));
    }
    out = value == 0 ? by_default : value;
    return absl::OkStatus();
  };
  double radius_m = 0, length_m = 0, width_m = 0, height_m = 0;
  for (const absl::Status& status :
       {dimension("radius_m", what.radius_m, kind->radius_m, radius_m),
        dimension("length_m", what.length_m, kind->length_m, length_m),
        dimension("width_m", what.width_m, kind->width_m, width_m),
        dimension("height_m", what.height_m, kind->height_m, height_m)})
    if (!status.ok()) return status;
  if (what.kind == "cooling_tower" &&
      !(std::min(length_m, width_m) > cooling_tower_reach(radius_m))) {
    return absl::InvalidArgumentError(
        fmt::format("a cooling_tower with radius_m = {} has a stack {:.4g} m wide, expected a "
                    "casing longer and "
                    "wider than that",
                    radius_m, cooling_tower_reach(radius_m)));
  }

  const std::uint64_t n = what.triangles;
  Mesh mesh = what.kind == "disk"       ? make_disk(radius_m, n)
              : what.kind == "sphere"   ? make_sphere(radius_m, n)
              : what.kind == "box"      ? make_box({length_m, width_m, height_m}, n)
              : what.kind == "cylinder" ? make_cylinder(radius_m, length_m, n)
              : what.kind == "cone"     ? make_cone(radius_m, length_m, n)
              : what.kind == "frigate"
                  ? make_frigate(length_m, width_m, height_m, n)
                  : make_cooling_tower(radius_m, length_m, width_m, height_m, n);
  mesh.degenerate_triangles = count_degenerate(mesh);
  return mesh;
}

}  // namespace irsig
