#include "verify/watertight/watertight_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/scene/import/import_mesh.h"
#include "fmt/format.h"
#include "verify/watertight/hit_judge.h"

namespace irsig {
namespace {

constexpr float kInfinityF = std::numeric_limits<float>::infinity();
constexpr float kOff = -1;  // as a ray's end

// Random numbers by counter: number k of ray i.
class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t ray) : state_(mix64(seed ^ mix64(ray))) {}
  double unit() {  // [0, 1)
    state_ = mix64(state_);
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  std::uint32_t below(std::size_t count) {
    return std::min(static_cast<std::uint32_t>(unit() * static_cast<double>(count)),
                    static_cast<std::uint32_t>(count - 1));
  }
  Point3 direction() {
    const double z = 2 * unit() - 1, phi = 2 * std::numbers::pi * unit();
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::uint64_t state_;
};

using Ray = HitJudge::Ray;  // of floats' exact values
using Hit = HitJudge::Hit;
using Verdict = HitJudge::Verdict;

class Checker {
 public:
  static absl::StatusOr<Checker> create(const Mesh& mesh, const WatertightCheck& what) {
    Checker checker(mesh, what);
    ASSIGN_OR_RETURN(
        checker.tracer_,
        Tracer::build(checker.judge_.vertex(), checker.judge_.triangle(), what.isa, what.options));
    if (!checker.find_origins())
      return absl::InvalidArgumentError("the mesh encloses no volume to start rays from");
    return checker;
  }

  WatertightCounts run() {
    for (std::uint64_t first = 0; first < what_.rays; first += RayPacket::kSize)
      trace(first, static_cast<int>(std::min<std::uint64_t>(RayPacket::kSize, what_.rays - first)));
    counts_.rays = what_.rays;
    counts_.tolerance_m = judge_.tolerance_m();
    counts_.near_vertices = tracer_->vertex_counts();
    return counts_;
  }

 private:
  Checker(const Mesh& mesh, const WatertightCheck& what) : what_(what), judge_(mesh) {}

  bool find_origins() {
    constexpr std::size_t kOrigins = 1024, kTries = 1000 * kOrigins;
    for (std::size_t i = 0; i < kTries && origin_.size() < kOrigins; ++i) {
      Draw draw(mix64(what_.seed) ^ 0x6f726967ULL, i);
      Point3 at;
      for (std::size_t j = 0; j < 3; ++j)
        at[j] = static_cast<float>((2 * draw.unit() - 1) * judge_.half_size()[j]);
      int crossings = 0;  // out less in
      for (const Hit& hit : judge_.reference().all(at, draw.direction(), 0, kInfinityF))
        crossings += hit.front ? -1 : 1;
      if (crossings != 0) origin_.push_back(at);
    }
    return origin_.size() == kOrigins;
  }

  Ray ray(std::uint64_t number) const {
    Draw draw(what_.seed, number);
    Ray out{origin_[draw.below(origin_.size())], {}};
    if (what_.aimed_at == AimedAt::kRandom) {
      out.direction = draw.direction();
    } else {
      const std::size_t facet = draw.below(judge_.triangle().size() / 3), corner = draw.below(3);
      const auto vertex = [&](std::size_t k) {
        return &judge_.vertex()[3 * std::size_t{judge_.triangle()[3 * facet + k % 3]}];
      };
      const float *a = vertex(corner), *b = vertex(corner + 1);
      const double s = what_.aimed_at == AimedAt::kEdges ? draw.unit() : 0;
      for (std::size_t j = 0; j < 3; ++j)
        out.direction[j] =
            (1 - s) * static_cast<double>(a[j]) + s * static_cast<double>(b[j]) - out.origin[j];
    }
    for (double& x : out.direction) x = static_cast<float>(x);
    return out;
  }

  void fail(std::uint64_t& count, const char* what, const Ray& ray, const Hit& truth,
            const Hit& answer) {
    ++count;
    if (!counts_.first_failure.empty()) return;
    const auto number = [](const Hit& hit) { return hit.met() ? std::int64_t{hit.facet} : -1; };
    counts_.first_failure = fmt::format(
        "{}: from ({:.9g}, {:.9g}, {:.9g}) along ({:.9g}, {:.9g}, {:.9g}): facet {} at {:.9g}, "
        "the tracer says facet {} at {:.9g}",
        what, ray.origin[0], ray.origin[1], ray.origin[2], ray.direction[0], ray.direction[1],
        ray.direction[2], number(truth), truth.t, number(answer), answer.t);
  }

  void trace(std::uint64_t first, int count) {
    RayPacket packet;
    Ray rays[RayPacket::kSize];
    for (int i = 0; i < RayPacket::kSize; ++i) {
      rays[i] = ray(first + static_cast<std::uint64_t>(std::min(i, count - 1)));
      fill(packet, i, rays[i], kInfinityF);
    }
    RayPacket near = packet, far = packet;
    tracer_->intersect(packet, count, what_.coherent);
    Hit truth[RayPacket::kSize];
    for (int i = 0; i < count; ++i) {
      const Hit answer = packet.triangle[i] == RayPacket::kMiss
                             ? Hit{}
                             : Hit{packet.triangle[i], false, static_cast<double>(packet.tfar[i])};
      truth[i] = judge_.truth(rays[i]);
      switch (judge_.judge(rays[i], truth[i], answer)) {
        case Verdict::kRight:
          break;
        case Verdict::kWithinTolerance:
          ++counts_.within_tolerance;
          break;
        case Verdict::kLost:
          fail(counts_.lost, "lost", rays[i], truth[i], answer);
          break;
        case Verdict::kInvented:
          fail(counts_.invented, "invented", rays[i], truth[i], answer);
          break;
      }
    }
    trace_shadows(rays, truth, count, near, far);
  }

  // Shadow rays that end a thousandth before and behind the hit, where that is clear of it.
  void trace_shadows(const Ray* rays, const Hit* truth, int count, RayPacket& near,
                     RayPacket& far) {
    double before[RayPacket::kSize], behind[RayPacket::kSize];
    for (int i = 0; i < RayPacket::kSize; ++i) {
      const Point3& d = rays[i].direction;
      const bool ask = i < count && truth[i].met() &&
                       0.001 * truth[i].t * std::hypot(d[0], d[1], d[2]) > 8 * judge_.tolerance_m();
      near.tfar[i] = ask ? static_cast<float>(0.999 * truth[i].t) : kOff;
      far.tfar[i] = ask ? static_cast<float>(1.001 * truth[i].t) : kOff;
      before[i] = near.tfar[i];
      behind[i] = far.tfar[i];
    }
    tracer_->occluded(near, count, what_.coherent);
    tracer_->occluded(far, count, what_.coherent);
    for (int i = 0; i < count; ++i) {
      if (before[i] == kOff) continue;
      if (near.tfar[i] == -kInfinityF && !judge_.blocked_nearby(rays[i], before[i], true))
        fail(counts_.shadow_invented, "shadow invented", rays[i], truth[i], {});
      if (far.tfar[i] != -kInfinityF && !judge_.blocked_nearby(rays[i], behind[i], false))
        fail(counts_.shadow_lost, "shadow lost", rays[i], truth[i], {});
    }
  }

  static void fill(RayPacket& p, int i, const Ray& ray, float end) {
    p.org_x[i] = static_cast<float>(ray.origin[0]);
    p.org_y[i] = static_cast<float>(ray.origin[1]);
    p.org_z[i] = static_cast<float>(ray.origin[2]);
    p.dir_x[i] = static_cast<float>(ray.direction[0]);
    p.dir_y[i] = static_cast<float>(ray.direction[1]);
    p.dir_z[i] = static_cast<float>(ray.direction[2]);
    p.tnear[i] = p.time[i] = 0;
    p.tfar[i] = end;
    p.mask[i] = 0xffffffffu;
    p.id[i] = p.flags[i] = 0;
    p.triangle[i] = p.geometry[i] = p.instance[i] = RayPacket::kMiss;
  }

  WatertightCheck what_;
  HitJudge judge_;
  std::unique_ptr<Tracer> tracer_;
  std::vector<Point3> origin_;
  WatertightCounts counts_;
};

}  // namespace

absl::StatusOr<WatertightCounts> check_watertight(const Mesh& mesh, const WatertightCheck& check) {
  if (mesh.vertex.empty() || mesh.triangle.empty())
    return absl::InvalidArgumentError("the mesh is empty");
  ASSIGN_OR_RETURN(Checker checker, Checker::create(mesh, check));
  return checker.run();
}

absl::StatusOr<Mesh> import_from_offset(const Mesh& mesh, double offset_m) {
  Mesh moved = mesh;
  for (Vec<Body>& v : moved.vertex) v = v + Vec<Body>{offset_m, offset_m, offset_m};
  MeshImport how;
  how.file_name = "moved.obj";
  how.reference = "bbox_center";
  return import_mesh(write_obj(moved), how);
}

}  // namespace irsig
