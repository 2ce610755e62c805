// The ship paper's comparison of ray-facet tests, redone: lost and invented hits on the frigate by
// its naive test (RTM), its improved one (IRTM), Embree (fast, ROBUST) and our ray tracer, and what
// each costs.
//   ray_facet_bench [triangles, 200000] [rays of each kind, 100000]
// The paper's tests and Embree's alone work on coordinates as far from the origin as the file has
// them, ours on the re-centred import of a text file with such coordinates. Every answer is judged
// by exact arithmetic (verify/watertight/hit_judge.h) on the frigate at the origin.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <random>

#include "core/scene/generate/generate_mesh.h"
#include "tests/benchmark/paper_ray_facet.h"
#include "verify/watertight/hit_judge.h"
#include "verify/watertight/watertight_check.h"

namespace irsig {
namespace {

using Ray = HitJudge::Ray;
using Hit = HitJudge::Hit;
using Verdict = HitJudge::Verdict;

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Makes rays from sensors all around at 1.3 radii: to points of facets, of edges, and to vertices.
std::vector<Ray> rays_at(const HitJudge& judge, AimedAt aimed_at, std::size_t count) {
  std::mt19937_64 random(20261121 + static_cast<unsigned>(aimed_at));
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  std::vector<Ray> out(count);
  for (Ray& ray : out) {
    Point3 side{normal(random), normal(random), normal(random)};
    const double size = std::hypot(side[0], side[1], side[2]);
    const std::size_t facet = random() % (judge.triangle().size() / 3), corner = random() % 3;
    double a = unit(random), b = unit(random);
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    if (aimed_at != AimedAt::kRandom) b = 0;
    if (aimed_at == AimedAt::kVertices) a = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      const auto at = [&](std::size_t k) {
        return static_cast<double>(
            judge.vertex()[3 * std::size_t{judge.triangle()[3 * facet + (corner + k) % 3]} + j]);
      };
      ray.origin[j] = static_cast<float>(1.3 * judge.radius_m() * side[j] / size);
      ray.direction[j] =
          static_cast<float>((1 - a - b) * at(0) + a * at(1) + b * at(2) - ray.origin[j]);
    }
  }
  return out;
}

void load(RayPacket& p, int i, const Ray& ray, double offset_m) {
  p.org_x[i] = static_cast<float>(ray.origin[0] + offset_m);
  p.org_y[i] = static_cast<float>(ray.origin[1] + offset_m);
  p.org_z[i] = static_cast<float>(ray.origin[2] + offset_m);
  p.dir_x[i] = static_cast<float>(ray.direction[0]);
  p.dir_y[i] = static_cast<float>(ray.direction[1]);
  p.dir_z[i] = static_cast<float>(ray.direction[2]);
  p.tnear[i] = p.time[i] = 0;
  p.tfar[i] = std::numeric_limits<float>::infinity();
  p.mask[i] = 0xffffffffu;
  p.id[i] = p.flags[i] = 0;
  p.triangle[i] = p.geometry[i] = p.instance[i] = RayPacket::kMiss;
}

std::vector<Hit> embree(const Tracer& tracer, const std::vector<Ray>& rays, double offset_m) {
  std::vector<Hit> out(rays.size());
  for (std::size_t first = 0; first < rays.size(); first += RayPacket::kSize) {
    RayPacket p;
    const int count =
        static_cast<int>(std::min<std::size_t>(RayPacket::kSize, rays.size() - first));
    for (int i = 0; i < RayPacket::kSize; ++i)
      load(p, i, rays[first + static_cast<std::size_t>(std::min(i, count - 1))], offset_m);
    tracer.intersect(p, count, false);
    for (int i = 0; i < count; ++i)
      if (p.triangle[i] != RayPacket::kMiss)
        out[first + static_cast<std::size_t>(i)] = {p.triangle[i], false,
                                                    static_cast<double>(p.tfar[i])};
  }
  return out;
}

template <typename Real>
std::vector<Hit> paper(const PaperTracer<Real>& tracer, const std::vector<Ray>& rays,
                       PaperTest test) {
  std::vector<Hit> out;
  out.reserve(rays.size());
  for (const Ray& ray : rays) out.push_back(tracer.nearest(ray.origin, ray.direction, test));
  return out;
}

struct Batch {
  const char* name;
  std::vector<Ray> rays;
  std::vector<Hit> truth;
};

template <typename Trace>
void count(const HitJudge& judge, const std::vector<Batch>& batches, const char* method,
           double offset_m, Trace&& trace) {
  for (const Batch& batch : batches) {
    const double start = cpu_s();
    const std::vector<Hit> answers = trace(batch.rays);
    const double ns = 1e9 * (cpu_s() - start) / static_cast<double>(batch.rays.size());
    unsigned long long verdicts[4]{};
    for (std::size_t i = 0; i < answers.size(); ++i)
      ++verdicts[static_cast<std::size_t>(judge.judge(batch.rays[i], batch.truth[i], answers[i]))];
    std::printf("%s,%g,%s,%zu,%llu,%llu,%llu,%.0f\n", method, offset_m, batch.name, answers.size(),
                verdicts[2], verdicts[3], verdicts[1], ns);
    std::fflush(stdout);
  }
}

std::unique_ptr<Tracer> build(const std::vector<float>& vertex,
                              const std::vector<std::uint32_t>& triangle, TracerOptions options) {
  return Tracer::build(vertex, triangle, widest_isa(), options).value();
}

void compare(const HitJudge& judge, const Mesh& mesh, std::size_t rays) {
  std::vector<Batch> batches;
  for (const AimedAt aimed_at : {AimedAt::kRandom, AimedAt::kEdges, AimedAt::kVertices}) {
    constexpr const char* names[] = {"facets", "edges", "vertices"};
    Batch batch{names[static_cast<int>(aimed_at)], rays_at(judge, aimed_at, rays), {}};
    for (const Ray& ray : batch.rays) batch.truth.push_back(judge.truth(ray));
    batches.push_back(std::move(batch));
  }
  std::printf("method,offset_m,aimed_at,rays,lost,invented,within_tolerance,ns_per_ray\n");
  for (const double offset_m : {0.0, 1e3, 1e5, 6.4e6}) {
    const auto by_paper = [&]<typename Real>(Real, const char* rtm, const char* irtm) {
      const PaperTracer<Real> tracer(judge.vertex(), judge.triangle(), offset_m);
      count(judge, batches, rtm, offset_m,
            [&](const auto& r) { return paper(tracer, r, PaperTest::kRtm); });
      count(judge, batches, irtm, offset_m,
            [&](const auto& r) { return paper(tracer, r, PaperTest::kIrtm); });
    };
    by_paper(float{}, "rtm_float", "irtm_float");
    by_paper(double{}, "rtm_double", "irtm_double");
    std::vector<float> moved = judge.vertex();
    for (float& x : moved) x = static_cast<float>(static_cast<double>(x) + offset_m);
    for (const bool robust : {false, true}) {
      const auto tracer = build(moved, judge.triangle(), {robust, TracerGuard::kNone});
      count(judge, batches, robust ? "embree_robust" : "embree_fast", offset_m,
            [&](const auto& r) { return embree(*tracer, r, offset_m); });
    }
    // Our way: the file at the offset, re-centred on import.
    const HitJudge imported(import_from_offset(mesh, offset_m).value());
    constexpr TracerGuard guards[] = {TracerGuard::kNone, TracerGuard::kEdges,
                                      TracerGuard::kVertices};
    constexpr const char* names[] = {"recentred_robust", "irsig_edges", "irsig"};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto tracer = build(imported.vertex(), imported.triangle(), {true, guards[k]});
      count(judge, batches, names[k], offset_m,
            [&](const auto& r) { return embree(*tracer, r, 0); });
    }
  }
}

// Measures the cost of ROBUST and of the guard at edges and vertices, on rays as the path tracer
// sends them.
void cost(const HitJudge& judge) {
  struct Packets {
    const char* name;
    bool coherent, shadow;
    std::vector<RayPacket> packet;
  };
  std::vector<Packets> kinds = {{"primary", true, false, {}},
                                {"diffuse_bounce", false, false, {}},
                                {"sun_shadow", true, true, {}}};
  const auto reference = build(judge.vertex(), judge.triangle(), {});
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  // Parallel rays from abeam and 20 deg above, a packet to each quarter of a square metre, and what
  // goes on from where they hit.
  const double c = std::cos(0.349), s = std::sin(0.349);
  std::vector<Ray> bounce, shadow;
  for (double x = -78; x < 78; x += 0.5) {
    for (double z = -24; z < 24; z += 0.5) {
      RayPacket p;
      for (int i = 0; i < RayPacket::kSize; ++i) {
        const double up = z + 0.5 * unit(random);
        load(p, i, {{x + 0.5 * unit(random), 110 * c - up * s, -110 * s - up * c}, {0, -c, s}}, 0);
      }
      kinds[0].packet.push_back(p);
      reference->intersect(p, RayPacket::kSize, true);
      for (int i = 0; i < RayPacket::kSize; ++i) {
        if (p.triangle[i] == RayPacket::kMiss) continue;
        const double size = std::hypot(p.normal_x[i], p.normal_y[i], p.normal_z[i]);
        const Point3 n{p.normal_x[i] / size, p.normal_y[i] / size, p.normal_z[i] / size};
        const double t = p.tfar[i], off = 2 * judge.tolerance_m();
        const Point3 at{p.org_x[i] + t * p.dir_x[i] + off * n[0],
                        p.org_y[i] + t * p.dir_y[i] + off * n[1],
                        p.org_z[i] + t * p.dir_z[i] + off * n[2]};
        const double cosine = 2 * unit(random) - 1, phi = 6.283185307 * unit(random),
                     r = std::sqrt(1 - cosine * cosine);
        bounce.push_back({at, {n[0] + r * std::cos(phi), n[1] + r * std::sin(phi), n[2] + cosine}});
        shadow.push_back({at, {0.5, 0.3, -0.8}});
      }
    }
  }
  for (std::size_t first = 0; first + 16 <= bounce.size(); first += 16) {
    RayPacket p, q;
    for (int i = 0; i < 16; ++i) {
      load(p, i, bounce[first + static_cast<std::size_t>(i)], 0);
      load(q, i, shadow[first + static_cast<std::size_t>(i)], 0);
    }
    kinds[1].packet.push_back(p);
    kinds[2].packet.push_back(q);
  }
  constexpr TracerOptions options[] = {{false, TracerGuard::kNone},
                                       {true, TracerGuard::kNone},
                                       {true, TracerGuard::kEdges},
                                       {true, TracerGuard::kVertices}};
  constexpr const char* names[] = {"fast", "robust", "irsig_edges", "irsig"};
  std::vector<std::unique_ptr<Tracer>> tracers;
  std::printf("tracer,build_ms\n");
  for (std::size_t k = 0; k < 4; ++k) {
    const double start = cpu_s();
    tracers.push_back(build(judge.vertex(), judge.triangle(), options[k]));
    std::printf("%s,%.0f\n", names[k], 1e3 * (cpu_s() - start));
  }
  std::printf("rays,tracer,ns_per_ray,over_robust\n");
  for (const Packets& kind : kinds) {
    std::vector<double> ns[4];
    for (int repeat = 0; repeat < 11; ++repeat) {
      for (std::size_t k = 0; k < 4; ++k) {
        double seconds = 0;
        // Batches are as large as the path tracer's: in the second-level cache.
        std::vector<RayPacket> batch(64);
        for (std::size_t first = 0; first + 64 <= kind.packet.size(); first += 64) {
          std::copy_n(kind.packet.begin() + static_cast<std::ptrdiff_t>(first), 64, batch.begin());
          const double start = cpu_s();
          for (RayPacket& p : batch) {
            if (kind.shadow)
              tracers[k]->occluded(p, RayPacket::kSize, kind.coherent);
            else
              tracers[k]->intersect(p, RayPacket::kSize, kind.coherent);
          }
          seconds += cpu_s() - start;
        }
        ns[k].push_back(1e9 * seconds / static_cast<double>(kind.packet.size() / 64 * 1024));
      }
    }
    for (auto& v : ns) std::sort(v.begin(), v.end());
    for (std::size_t k = 0; k < 4; ++k)
      std::printf("%s,%s,%.1f,%.3f\n", kind.name, names[k], ns[k][5], ns[k][5] / ns[1][5]);
  }
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  using namespace irsig;
  const std::uint64_t triangles = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 200'000;
  const std::uint64_t rays = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 100'000;
  const Mesh mesh = generate_mesh({"frigate", triangles}).value();
  const HitJudge judge(mesh);
  cost(judge);
  if (rays > 0) compare(judge, mesh, rays);
}
