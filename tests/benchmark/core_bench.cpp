// Measures the radiometric core beside its ray tracer, as ratios of CPU time in one process on the
// same rays:
//   core_bench [triangles] [samples]
// Prints one CSV line a figure; docs/evidence/performance.md quotes them.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <numbers>
#include <vector>

#include "core/base/constants.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/scene/trace/embree.h"
#include "core/signature/simulator.h"
#include "core/transport/path_tracer.h"

namespace irsig {
namespace {

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

// Keeps every packet that passes through.
class Recorder final : public Tracer {
 public:
  explicit Recorder(std::shared_ptr<const Tracer> inner) : inner_(std::move(inner)) {}
  struct Call {
    RayPacket packet;
    int count;
    bool coherent, shadow;
  };
  void intersect(RayPacket& p, int count, bool coherent) const override {
    calls_.push_back({p, count, coherent, false});
    inner_->intersect(p, count, coherent);
  }
  void occluded(RayPacket& p, int count, bool coherent) const override {
    calls_.push_back({p, count, coherent, true});
    inner_->occluded(p, count, coherent);
  }
  bool look_for_front(RayPacket& p, int lane, float sheet_m) const override {
    return inner_->look_for_front(p, lane, sheet_m);
  }
  mutable std::vector<Call> calls_;

 private:
  std::shared_ptr<const Tracer> inner_;
};

// Sends these rays through Embree alone, by three entry points: the recorded packets of 16; full
// packets of 16, regardless of a ray's batch; the stream interface.
struct Replay {
  RTCDevice device;
  RTCScene scene;
  explicit Replay(const Target& target) {
    device = rtcNewDevice(("threads=1,set_affinity=0,isa=" + isa_name(widest_isa())).c_str());
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry g = new_unmasked_geometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::memcpy(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                        target.vertex.size() / 3),
                target.vertex.data(), target.vertex.size() * 4);
    std::memcpy(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                        target.triangle.size() / 3),
                target.triangle.data(), target.triangle.size() * 4);
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene, g);
    rtcCommitScene(scene);
  }
  double packets(std::vector<Recorder::Call> calls) const {  // by value: tracing overwrites
    alignas(64) int valid[16];
    const double start = cpu_s();
    for (Recorder::Call& call : calls) {
      EmbreeQuery query(call.coherent);
      for (int i = 0; i < 16; ++i) valid[i] = i < call.count ? -1 : 0;
      if (call.shadow)
        query.occluded(valid, scene, call.packet);
      else
        query.intersect(valid, scene, call.packet);
    }
    return cpu_s() - start;
  }
  // stream: by the stream interface, which Embree 4 does not have: there as without it.
  double single(const std::vector<Recorder::Call>& calls, [[maybe_unused]] bool stream) const {
    std::vector<RTCRayHit> rays[3];
    for (const Recorder::Call& call : calls)
      for (int i = 0; i < call.count; ++i) {
        RTCRayHit r{};
        const RayPacket& p = call.packet;
        r.ray = {p.org_x[i], p.org_y[i], p.org_z[i], p.tnear[i],  p.dir_x[i], p.dir_y[i],
                 p.dir_z[i], 0,          p.tfar[i],  0xffffffffu, 0,          0};
        r.hit.geomID = r.hit.primID = RTC_INVALID_GEOMETRY_ID;
        rays[call.shadow ? 2 : call.coherent ? 0 : 1].push_back(r);
      }
    const double start = cpu_s();
    for (int kind = 0; kind < 3; ++kind) {
      EmbreeQuery query(kind != 1);
#ifndef IRSIG_EMBREE_4
      if (stream) {
        RTCIntersectContext c;
        rtcInitIntersectContext(&c);
        c.flags =
            kind != 1 ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        for (std::size_t first = 0; first < rays[kind].size(); first += 1024) {
          const auto n =
              static_cast<unsigned>(std::min<std::size_t>(1024, rays[kind].size() - first));
          if (kind == 2)
            rtcOccluded1M(scene, &c, &rays[kind][first].ray, n, sizeof(RTCRayHit));
          else
            rtcIntersect1M(scene, &c, &rays[kind][first], n, sizeof(RTCRayHit));
        }
        continue;
      }
#endif
      for (RTCRayHit& r : rays[kind])
        if (kind == 2)
          query.occluded(scene, r.ray);
        else
          query.intersect(scene, r);
    }
    return cpu_s() - start;
  }
};

SceneSpec frigate(std::uint64_t triangles) {
  SceneSpec scene;
  scene.mesh = generate_mesh({"frigate", triangles, 0, 0, 0, 0}).value();
  scene.material = {*builtin_material("hull")};
  for (const std::string& g : scene.mesh.group) scene.part.push_back({g, {}, 0, false, false});
  scene.band = {{"MWIR", 3, 5, 0.05, {}}, {"LWIR", 8, 12, 0.05, {}}};
  return scene;
}

Vec<Body> sun_at(double azimuth_deg, double zenith_deg) {
  const double a = azimuth_deg * std::numbers::pi / 180, z = zenith_deg * std::numbers::pi / 180;
  return {std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)};
}

struct Case {
  const char* name;
  std::uint32_t reflections;
  std::vector<SunDirection> suns;
};

void against_replay(const Simulator& simulator, std::uint64_t samples, const Case& what) {
  Target target = simulator.target();
  const auto plain = target.tracer;
  const std::vector<Viewpoint> views = {
      {0, 10, 5000}, {90, 5, 5000}, {45, 45, 5000}, {200, 80, 5000}};
  std::vector<double> ratios;
  double rays_per_s = 0;
  const Replay replay(target);
  // The whole view by the same tracer with fewer guards, over that with Embree's ROBUST alone.
  constexpr const char* guards[] = {"fast", "robust", "guarded_edges", "guarded_vertices"};
  const auto with = [&](bool robust, TracerGuard guard) -> std::shared_ptr<const Tracer> {
    return Tracer::build(target.vertex, target.triangle, widest_isa(), {robust, guard}).value();
  };
  const std::shared_ptr<const Tracer> guarded[] = {
      with(false, TracerGuard::kNone), with(true, TracerGuard::kNone),
      with(true, TracerGuard::kEdges), with(true, TracerGuard::kVertices)};
  std::vector<double> over_robust[4];
  for (const Viewpoint& view : views) {
    PathSettings settings;
    settings.max_reflections = what.reflections;
    settings.seed = 1;
    settings.samples = samples / 32;
    SourceGeometry sources;
    sources.boundary = Sea{{-target.centre.z, kEarthRadiusM}};
    sources.sun = what.suns;
    const AimedView aimed = make_aimed_view(target, view);
    const auto trace = [&](PathCounts& counts) {
      const PathTracer tracer(target, simulator.materials(), aimed, sources, settings);
      const double start = cpu_s();
      tracer.trace(counts);
      return cpu_s() - start;
    };
    const auto recorder = std::make_shared<Recorder>(plain);
    target.tracer = recorder;
    PathCounts counts;
    trace(counts);
    target.tracer = plain;
    for (int repeat = 0; repeat < 7; ++repeat) {
      PathCounts again;
      const double ours = trace(again);
      const double best =
          std::min({replay.packets(recorder->calls_), replay.single(recorder->calls_, true),
                    replay.single(recorder->calls_, false)});
      ratios.push_back(best / ours);
      double seconds[4];
      for (std::size_t k = 0; k < 4; ++k) {
        target.tracer = guarded[k];
        PathCounts same;
        seconds[k] = trace(same);
      }
      for (std::size_t k = 0; k < 4; ++k) over_robust[k].push_back(seconds[k] / seconds[1]);
      target.tracer = plain;
      if (repeat == 0)
        std::printf(
            "# %s view %g/%g: %llu samples, %llu target paths, %llu rays; ns/ray: ours %.1f, "
            "packets %.1f, stream %.1f, single %.1f\n",
            what.name, view.aspect_azimuth_deg, view.aspect_elevation_deg,
            static_cast<unsigned long long>(again.samples),
            static_cast<unsigned long long>(again.target_paths),
            static_cast<unsigned long long>(again.rays),
            1e9 * ours / static_cast<double>(again.rays),
            1e9 * replay.packets(recorder->calls_) / static_cast<double>(again.rays),
            1e9 * replay.single(recorder->calls_, true) / static_cast<double>(again.rays),
            1e9 * replay.single(recorder->calls_, false) / static_cast<double>(again.rays));
      rays_per_s = std::max(rays_per_s, static_cast<double>(again.rays) / ours);
    }
  }
  std::printf("%s,replay_over_ours,%.3f\n%s,rays_per_s,%.3g\n", what.name, median(ratios),
              what.name, rays_per_s);
  for (std::size_t k = 0; k < 4; ++k)
    std::printf("%s,%s_over_robust,%.3f\n", what.name, guards[k], median(over_robust[k]));
}

double simulate_s(const Simulator& simulator, const ViewRequest& request) {
  const double start = cpu_s();
  const auto view = simulator.simulate(request);
  if (!view.ok()) std::fprintf(stderr, "%s\n", view.status().ToString().c_str());
  return cpu_s() - start;
}

ConditionSpec condition(const Simulator& simulator, double t_k, bool sun, double azimuth_deg) {
  ConditionSpec c;
  c.part_temperature_k.assign(simulator.target().part.size(), t_k);
  c.surroundings = {SurroundingsKind::kSea, 250, 0, t_k - 5, 0.97, 0};
  c.sun = sun;
  c.sun_direction = sun_at(azimuth_deg, 40);
  c.sun_cos_zenith = std::cos(40 * std::numbers::pi / 180);
  c.sun_angular_radius_deg = 0.266;
  c.sun_scale = 0.5;
  return c;
}

// Measures the cost of one more condition in a view of 1.56 M target paths.
void conditions(const Simulator& simulator) {
  ViewRequest base;
  base.viewpoint = {60, 30, 5000};
  base.selected_band = {0, 1};
  base.accuracy.samples_per_replicate = 57344;
  const auto with = [&](std::vector<ConditionSpec> list) {
    ViewRequest r = base;
    r.condition = std::move(list);
    for (std::uint32_t i = 0; i < r.condition.size(); ++i) r.selected_condition.push_back(i);
    return r;
  };
  const auto night = [&](double t) { return condition(simulator, t, false, 0); };
  const auto day = [&](double t, double az) { return condition(simulator, t, true, az); };
  std::vector<double> season, sun;
  for (int repeat = 0; repeat < 5; ++repeat) {
    // Ten more seasons and four more suns at once, so that the difference stands out of the noise.
    std::vector<ConditionSpec> nights, days;
    for (int i = 0; i < 11; ++i) nights.push_back(night(285 + i));
    for (int i = 0; i < 5; ++i) days.push_back(day(285, 20 + 60 * i));
    const double one_night = simulate_s(simulator, with({night(285)})),
                 more_nights = simulate_s(simulator, with(nights));
    const double one_day = simulate_s(simulator, with({day(285, 20)})),
                 more_days = simulate_s(simulator, with(days));
    season.push_back((more_nights - one_night) / 10 / one_night);
    sun.push_back((more_days - one_day) / 4 / one_day);
  }
  std::printf("one_more_night_season,over_first,%.4f\none_more_sun,over_first,%.3f\n",
              median(season), median(sun));
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  using namespace irsig;
  const std::uint64_t triangles = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 200000;
  const std::uint64_t samples = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1u << 19;
  const auto simulator = Simulator::create(frigate(triangles)).value();
  std::printf("figure,quantity,value\n");
  std::printf("triangles,count,%zu\n", simulator->target().facet.size());
  against_replay(*simulator, samples, {"primary", 0, {}});
  against_replay(*simulator, samples,
                 {"three_reflections_and_sun", 3, {{sun_at(60, 40), 0.00465}}});
  conditions(*simulator);
}
