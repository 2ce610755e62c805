// The full count of lost and invented hits:
//   watertight_bench [random rays, 1e8] [rays aimed at edges, and as many at vertices, 1e6]
// The rays are shared out over the hard closed meshes, at each offset of the model file's
// coordinates. One CSV line for each offset and aim; the exit code is 1 if anything failed.
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "verify/watertight/watertight_check.h"

namespace irsig {
namespace {

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

using Count = unsigned long long;

int run(std::uint64_t random_rays, std::uint64_t aimed_rays) {
  const std::vector<NamedMesh> meshes = hard_closed_meshes(20'000);
  std::printf(
      "offset_m,aimed_at,rays,lost,invented,shadow_lost,shadow_invented,within_tolerance,"
      "near_vertex,us_per_ray\n");
  const char* const name[] = {"random", "edges", "vertices"};
  std::uint64_t failures = 0;
  for (const double offset_m : {0.0, 1e3, 1e5, 6.4e6}) {
    for (const AimedAt aimed_at : {AimedAt::kRandom, AimedAt::kEdges, AimedAt::kVertices}) {
      WatertightCounts sum;
      const double start = cpu_s();
      for (const NamedMesh& hard : meshes) {
        WatertightCheck check;
        check.aimed_at = aimed_at;
        check.rays = (aimed_at == AimedAt::kRandom ? random_rays : aimed_rays) / meshes.size();
        check.seed = 20261121;
        const auto mesh = import_from_offset(hard.mesh, offset_m);
        const auto counts = mesh.ok() ? check_watertight(*mesh, check) : mesh.status();
        if (!counts.ok()) {
          std::fprintf(stderr, "%s: %s\n", hard.name.c_str(), counts.status().ToString().c_str());
          return 1;
        }
        if (counts->failures() > 0)
          std::printf("# %s: %s\n", hard.name.c_str(), counts->first_failure.c_str());
        sum.rays += counts->rays;
        sum.lost += counts->lost;
        sum.invented += counts->invented;
        sum.shadow_lost += counts->shadow_lost;
        sum.shadow_invented += counts->shadow_invented;
        sum.within_tolerance += counts->within_tolerance;
        sum.near_vertices.near_vertex += counts->near_vertices.near_vertex;
      }
      failures += sum.failures();
      std::printf("%g,%s,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%.2f\n", offset_m,
                  name[static_cast<int>(aimed_at)], Count{sum.rays}, Count{sum.lost},
                  Count{sum.invented}, Count{sum.shadow_lost}, Count{sum.shadow_invented},
                  Count{sum.within_tolerance}, Count{sum.near_vertices.near_vertex},
                  1e6 * (cpu_s() - start) / static_cast<double>(sum.rays));
      std::fflush(stdout);
    }
  }
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  const auto number = [&](int i, double otherwise) {
    return static_cast<std::uint64_t>(argc > i ? std::strtod(argv[i], nullptr) : otherwise);
  };
  return irsig::run(number(1, 1e8), number(2, 1e6));
}
