#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/arithmetic_fingerprint.h"
#include "core/base/status_macros.h"
#include "core/scene/generate/generate_mesh.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"
#include "verify/cases/ray_shots.h"

namespace irsig {
namespace {

// From the widest that this processor has to the narrowest.
std::vector<TracerIsa> instruction_sets() {
  std::vector<TracerIsa> out;
  for (const TracerIsa isa : {TracerIsa::kAvx512, TracerIsa::kAvx2, TracerIsa::kSse42})
    if (static_cast<int>(isa) >= static_cast<int>(widest_isa())) out.push_back(isa);
  return out;
}

// A ship with a glossy hull, a hot part and the sun: everything that a path can do.
absl::StatusOr<SceneSpec> ship(std::uint64_t triangles) {
  ASSIGN_OR_RETURN(auto mesh, generate_mesh({"frigate", triangles}));
  ASSIGN_OR_RETURN(auto hull, builtin_material("hull"));
  SceneSpec scene = one_body(std::move(mesh), std::move(hull));
  scene.part = {
      {"ship", {"hull", "deck", "superstructure", "funnel", "mast", "turret"}, 0, false, false},
      {"hot", {"*_*"}, 0, false, true}};
  return scene;
}

ViewRequest sunlit(const Simulator& simulator, std::uint64_t samples) {
  ViewRequest r = dark_view(simulator, 100, 12, 5000, {300, 450});
  r.condition[0].surroundings = {SurroundingsKind::kSea, 250, 0, 285, 0.96, 0};
  put_sun(r.condition[0], {0.2, 0.6, -0.7});
  r.max_reflections = 4;
  r.accuracy.samples_per_replicate = samples;
  r.thumbnail_px = 16;
  return r;
}

// Every number of a view, to be compared bit by bit.
std::vector<double> numbers(const ViewResult& view) {
  std::vector<double> out;
  const auto add = [&](const Estimate& e) {
    out.push_back(e.value);
    out.push_back(e.stderr_);
  };
  for (const SignatureResult& r : view.row) {
    add(r.intensity_w_sr);
    add(r.apparent_intensity_w_sr);
    add(r.projected_area_m2);
    for (const Estimate& e : r.cause_w_sr) add(e);
    for (const Estimate& e : r.part_w_sr) add(e);
    out.insert(out.end(), r.spectral.value.begin(), r.spectral.value.end());
    out.insert(out.end(), r.spectral.stderr_.begin(), r.spectral.stderr_.end());
    out.insert(out.end(), r.image_w_m2_sr.begin(), r.image_w_m2_sr.end());
    out.push_back(r.numerical_error_w_sr);
  }
  for (const std::uint64_t n : {view.samples, view.target_paths, view.rays, view.seed})
    out.push_back(static_cast<double>(n));
  return out;
}

double differing(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return INFINITY;
  double count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] ? 0 : 1;
  return count;
}

// Proves that a request gives the same bits on a scene that is built again, and on 1 to 4 threads
// at the same time.
absl::StatusOr<Finding> same_bits(Effort effort) {
  Worst worst(0);
  ASSIGN_OR_RETURN(const auto scene, ship(20000));
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  const ViewRequest r = sunlit(*simulator, effort == Effort::kFull ? 8192 : 512);
  ASSIGN_OR_RETURN(const auto first, simulator->simulate(r));
  const std::vector<double> expected = numbers(first);

  ASSIGN_OR_RETURN(const auto rebuilt, Simulator::create(scene));
  ASSIGN_OR_RETURN(const auto again, rebuilt->simulate(r));
  worst.see(differing(numbers(again), expected), [] { return "built again"; });

  for (const std::size_t threads : {1, 2, 4}) {
    std::vector<double> difference(threads, INFINITY);
    std::vector<std::thread> running;
    for (std::size_t i = 0; i < threads; ++i)
      running.emplace_back([&, i] {
        const auto view = simulator->simulate(r);
        if (view.ok()) difference[i] = differing(numbers(*view), expected);
      });
    for (std::thread& t : running) t.join();
    for (const double d : difference)
      worst.see(d, [&] { return absl::StrCat(threads, " threads: ", d, " numbers differ"); });
  }
  Finding out = worst.finding();
  if (out.worst_error == 0) out.where = absl::StrCat(expected.size(), " numbers each");
  return out;
}

// Compares equal rays on every instruction set that this processor has.
absl::StatusOr<Finding> instruction_set_views(Effort effort) {
  Worst worst(0.25);
  std::vector<ViewResult> views;
  std::string names;
  for (const TracerIsa isa : instruction_sets()) {
    ASSIGN_OR_RETURN(auto scene, ship(20000));
    scene.isa = isa;
    ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
    ASSIGN_OR_RETURN(
        auto view, simulator->simulate(sunlit(*simulator, effort == Effort::kFull ? 32768 : 2048)));
    views.push_back(std::move(view));
    absl::StrAppend(&names, names.empty() ? "" : ", ", isa_name(isa));
  }
  worst.require(true, [&] { return names; });
  for (std::size_t i = 1; i < views.size(); ++i) {
    const SignatureResult &a = views[0].row[0], &b = views[i].row[0];
    const auto see = [&](const Estimate& x, const Estimate& y, const char* what) {
      worst.see(std::abs(x.value - y.value) / std::max(x.stderr_, 1e-7 * std::abs(x.value)),
                [&] { return absl::StrCat(names, ": ", what, " of number ", i); });
    };
    see(a.intensity_w_sr, b.intensity_w_sr, "intensity");
    see(a.projected_area_m2, b.projected_area_m2, "area");
    see(a.part_w_sr[1], b.part_w_sr[1], "hot part");
  }
  return worst.finding();
}

absl::StatusOr<Finding> instruction_set_rays(Effort effort) {
  Worst worst(0.5);
  ASSIGN_OR_RETURN(auto mesh, generate_mesh({"frigate", 20000}));
  const std::uint64_t rays = effort == Effort::kFull ? 4'000'000 : 200'000;
  std::vector<Shot> first;
  std::string names;
  for (const TracerIsa isa : instruction_sets()) {
    const auto target = make_target(mesh, {{"body", {"*"}, 0, false, false}}, isa);
    if (!target.ok()) return target.status();
    absl::StrAppend(&names, names.empty() ? "" : ", ", isa_name(isa));
    const bool is_first = first.empty();
    if (is_first) first.resize(rays);
    std::uint64_t hits = 0, elsewhere = 0;
    shoot(
        *target->tracer, rays, false,
        [&](std::uint64_t i, Shot& shot) {
          const Vec<Body> d = uniform_direction(21, i);
          shot.direction = to_float3(d);
          const Vec<Body> at = 0.5 * target->radius_m * uniform_direction(22, i);
          shot.origin = to_float3(at - 2 * target->radius_m * d);
        },
        [&](std::uint64_t i, const Shot& shot) {
          if (is_first) first[i] = shot;
          hits += shot.hit ? 1 : 0;
          elsewhere +=
              shot.hit != first[i].hit || std::abs(shot.distance - first[i].distance) > 0.01f ? 1
                                                                                              : 0;
          if (shot.hit)
            worst.see(
                distance_from_plane_m(*target, shot.triangle, shot.point()) / target->offset_m(),
                [&] { return absl::StrCat(isa_name(isa), ", ray ", i); });
        });
    worst.require(static_cast<double>(elsewhere) <= 1e-5 * static_cast<double>(hits), [&] {
      return absl::StrCat(isa_name(isa), ": ", elsewhere, " of ", hits, " end on another surface");
    });
  }
  Finding out = worst.finding();
  absl::StrAppend(&out.where, " (of ", names, ")");
  return out;
}

// Ends the process when it has used so many seconds of CPU time.
void limit_cpu_s(rlim_t seconds) {
  const rlimit limit{seconds, seconds};
  setrlimit(RLIMIT_CPU, &limit);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
}

// Coherent packets through a pinhole three radii away, hits and shadows; how many hits, or none if
// the two disagree.
std::uint64_t coherent_hits(const Tracer& tracer, double radius_m, int run) {
  std::uint64_t hits = 0, blocked = 0;
  for (int view = 0; view < 8; ++view) {
    const Vec<Body> d = -1.0 * body_from_aspect(45.0 * view + run, 10 * view - 30);
    const Vec<Body> side = normalized(cross(d, Vec<Body>{0, 0, 1})), up = cross(side, d);
    constexpr std::uint64_t kSide = 256;
    const auto aim = [&](std::uint64_t i, Shot& shot) {
      // 4 x 4 rays of a packet side by side.
      const std::uint64_t tile = i / 16, in = i % 16;
      const double x = static_cast<double>(4 * (tile % (kSide / 4)) + in % 4) / kSide,
                   y = static_cast<double>(4 * (tile / (kSide / 4)) + in / 4) / kSide;
      shot.origin = to_float3(-3 * radius_m * d);
      shot.direction = to_float3(normalized(3.0 * d + (2 * x - 1) * side + (2 * y - 1) * up));
    };
    shoot(tracer, kSide * kSide, true, aim,
          [&](std::uint64_t, const Shot& shot) { hits += shot.hit ? 1 : 0; });
    // On plain triangles COMPACT loops here, in the first view.
    shoot_shadows(tracer, kSide * kSide, true, aim,
                  [&](std::uint64_t, bool in_the_way) { blocked += in_the_way ? 1 : 0; });
  }
  return blocked == hits ? hits : 0;
}

// Coherent packets of 16 on the ship, where Embree 3.13.5 with COMPACT never returns: in a child
// process that the system kills when it loops. The tracer as it is used, and Embree alone.
absl::StatusOr<Finding> no_endless_traversal(Effort effort) {
  Worst worst(0);
  ASSIGN_OR_RETURN(auto mesh, generate_mesh({"frigate", 50000}));
  const int runs = effort == Effort::kFull ? 12 : 2;
  for (const TracerIsa isa : instruction_sets())
    for (int run = 0; run < runs; ++run) {
      const pid_t child = fork();
      if (child < 0) return absl::InternalError("fork failed");
      if (child == 0) {
        limit_cpu_s(20);
        const auto target = make_target(mesh, {{"body", {"*"}, 0, false, false}}, isa);
        if (!target.ok()) _exit(2);
        const auto alone = Tracer::build(target->vertex, target->triangle, isa,
                                         {.robust = true, .guard = TracerGuard::kNone});
        if (!alone.ok()) _exit(2);
        _exit(coherent_hits(*target->tracer, target->radius_m, run) > 1000 &&
                      coherent_hits(**alone, target->radius_m, run) > 1000
                  ? 0
                  : 3);
      }
      int status = 0;
      while (waitpid(child, &status, 0) < 0) {
      }
      worst.require(WIFEXITED(status) && WEXITSTATUS(status) == 0, [&] {
        return absl::StrCat(isa_name(isa), ", run ", run,
                            WIFSIGNALED(status) ? ": killed after 20 s by signal " : ": exit code ",
                            WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
      });
      if (!worst.finding().holds()) return worst.finding();
    }
  return worst.finding();
}

// The name of what the last bit hangs on is a function of this machine, not of the moment.
absl::StatusOr<Finding> fingerprint(Effort) {
  Worst worst(0);
  const std::uint32_t first = arithmetic_fingerprint(true);
  worst.require(first != 0, [] { return "empty"; });
  std::vector<std::uint32_t> seen(4, 0);
  std::vector<std::thread> running;
  for (std::uint32_t& s : seen) running.emplace_back([&s] { s = arithmetic_fingerprint(true); });
  for (std::thread& t : running) t.join();
  for (const std::uint32_t s : seen) worst.require(s == first, [] { return "it changes"; });
  Finding out = worst.finding();
  if (out.holds()) out.where = absl::StrCat(absl::Hex(first, absl::kZeroPad8));
  return out;
}

}  // namespace

std::vector<HardCase> determinism_cases() {
  return {
      {"determinism", "same_bits", "built again, on 1, 2 and 4 threads: numbers that differ",
       "one determinism class promises every bit (docs/decisions/0010)", same_bits},
      {"determinism", "instruction_sets",
       "a sunlit ship by SSE 4.2, AVX2, AVX-512: difference [standard errors]",
       "the same random numbers: only rays within rounding of an edge end elsewhere, 1e-4 of all, "
       "and a hundredth part of them would make 0.1 standard errors",
       instruction_set_views},
      {"determinism", "instruction_set_rays",
       "the same rays by each: distance of hits off their facet [start offsets]; more than 1e-5 of "
       "them on another surface",
       "half an offset, as for any hit; silhouettes cover 1e-2 of a picture's width at most, of "
       "which floats cannot tell 1e-4",
       instruction_set_rays},
      {"determinism", "no_endless_traversal",
       "coherent packets of 16, hits and shadows, each instruction set: killed, or disagreeing",
       "the rays take 0.2 s of CPU time; 20 s is for ever", no_endless_traversal},
      {"determinism", "fingerprint", "hash of libm and approximate reciprocals: changes",
       "it names the determinism class, and must be a constant of the machine", fingerprint},
  };
}

}  // namespace irsig
