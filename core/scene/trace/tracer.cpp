#include "core/scene/trace/tracer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/check.h"
#include "core/base/clones.h"
#include "core/scene/trace/embree.h"
#include "core/scene/trace/facet_pairs.h"
#include "core/scene/trace/reference_tracer.h"
#include "core/scene/trace/same_corners.h"
#include "core/scene/trace/vertex_fans.h"

namespace irsig {
namespace {

// Lanes beyond `count` are switched off.
alignas(64) constexpr int kValid[32] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1,
                                        -1, -1, -1, -1, -1, 0,  0,  0,  0,  0,  0,
                                        0,  0,  0,  0,  0,  0,  0,  0,  0,  0};

constexpr std::uint32_t kFacets = 0, kCaps = 1;  // geometries of the scene, in this order

// How far the cap of a vertex reaches, in radii of the mesh. It encloses a third of that, about six
// times the error of a float32 edge test from two radii away. Occlusion rays stop at caps without
// further question: that is within the tolerance that the header states.
constexpr float kCapReach = 0x1p-20f;

// A barycentric coordinate below this is close to an edge. Embree lets a facet accept a ray that
// passes an edge outside by 2^-23 of its height; the rest is for neighbours of different size.
constexpr float kNearEdge = 0x1p-14f;
constexpr double kSameDistance = 0x1p-16;
constexpr float kFarM = 256;     // beyond, distances are known to 0.1 mm at best
constexpr double kNeedle = 256;  // longest side over height

struct Guard {
  Guard(VertexFans of, std::vector<std::array<std::uint32_t, 2>> facets)
      : fans(std::move(of)), pairs(std::move(facets)) {}
  VertexFans fans;
  std::vector<std::array<std::uint32_t, 2>> pairs;  // facets of each
  std::vector<bool> needle;                         // of each pair; empty where there is none
  mutable std::atomic<std::uint64_t> near_vertex{0}, decided{0};
};

// Sixteen lanes at once, by the compiler's vector arithmetic.
using Floats = float __attribute__((vector_size(64)));
using Ints = std::int32_t __attribute__((vector_size(64)));

// The facets of a packet's hits on pairs, and which rays need a closer look: those that met a cap
// or came close to an edge.
struct Sides {
  Ints second;  // of the pair: -1 or 0
  Ints doubtful;
  bool any;
};

IRSIG_CLONES void find_sides(const RayPacket& p, Sides& out) {
  Floats u, v;
  Ints geometry;
  std::memcpy(&u, p.u, sizeof(u));
  std::memcpy(&v, p.v, sizeof(v));
  std::memcpy(&geometry, p.geometry, sizeof(geometry));
  // Embree's coordinates of the second triangle of a pair count from the opposite corner.
  Floats w = 1.0f - u - v;
  const Ints second = w < 0.0f;
  u = second ? 1.0f - u : u;
  v = second ? 1.0f - v : v;
  w = second ? -w : w;
  const Ints near_edge = (u < kNearEdge) | (v < kNearEdge) | (w < kNearEdge);
  const Ints doubtful = ((geometry == static_cast<std::int32_t>(kFacets)) & near_edge) |
                        (geometry == static_cast<std::int32_t>(kCaps));
  std::int32_t any = 0;
  for (int i = 0; i < 16; ++i) any |= doubtful[i];
  out.second = second;
  out.doubtful = doubtful;
  out.any = any != 0;
}

bool all_miss(const RayPacket& p) {
  std::uint64_t part[8];
  std::memcpy(part, p.geometry, sizeof(part));
  std::uint64_t all = part[0];
  for (const std::uint64_t more : part) all &= more;
  return all == ~std::uint64_t{0};
}

float radius_of(const std::vector<float>& vertex) {
  float squared = 0;
  for (std::size_t i = 0; i + 2 < vertex.size(); i += 3)
    squared = std::max(squared, vertex[i] * vertex[i] + vertex[i + 1] * vertex[i + 1] +
                                    vertex[i + 2] * vertex[i + 2]);
  return std::sqrt(squared);
}

class EmbreeTracer final : public Tracer {
 public:
  EmbreeTracer(RTCDevice device, RTCScene scene, std::vector<float> vertex,
               std::vector<std::uint32_t> triangle, std::unique_ptr<Guard> guard,
               SameCorners same_corners)
      : device_(device),
        scene_(scene),
        vertex_(std::move(vertex)),
        triangle_(std::move(triangle)),
        guard_(std::move(guard)),
        same_corners_(std::move(same_corners)),
        is_large_(radius_of(vertex_) > 0.5f * kFarM),
        takes_sixteen_(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) !=
                       0) {}
  ~EmbreeTracer() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  bool look_for_front(RayPacket& p, int i, float sheet_m) const override {
    const Point3 origin = origin_of(p, i), direction = direction_of(p, i);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    ReferenceTracer::Hit hit = exact().nearest(origin, direction, p.tnear[i], kInfinity);
    if (!hit.met()) return false;
    if (!hit.front) {
      // Largest distance along the ray from the first sheet to the second.
      const Point3 n = normal_of(hit.facet);
      const double across =
          std::abs(n[0] * direction[0] + n[1] * direction[1] + n[2] * direction[2]) /
          std::hypot(n[0], n[1], n[2]);
      const double first = hit.t, last = first + static_cast<double>(sheet_m) / across;
      hit = {};
      for (const ReferenceTracer::Hit& other : exact().all(origin, direction, first, last))
        if (other.front &&
            (!hit.met() || other.t < hit.t || (other.t == hit.t && other.facet < hit.facet)))
          hit = other;
      if (!hit.met()) return false;
    }
    put(p, i, hit);
    return true;
  }

  void intersect(RayPacket& packet, int count, bool coherent) const override {
    EmbreeQuery query(coherent);
    alignas(64) int valid[16];
    std::memcpy(valid, kValid + 16 - count, sizeof(valid));
    switch_off_from(packet, count);
    float end[16];
    std::memcpy(end, packet.tfar, sizeof(end));
    query.intersect(valid, scene_, packet);
    if (is_large_) look_again(packet, count, end, query);
    if (guard_ == nullptr || all_miss(packet)) return;
    Sides sides;
    find_sides(packet, sides);
    if (!guard_->needle.empty()) {
      for (int i = 0; i < count; ++i) {
        if (!on_needle(packet.geometry[i], packet.triangle[i])) continue;
        sides.doubtful[i] = -1;
        sides.any = true;
      }
    }
    if (sides.any) {
      for (int i = 0; i < count; ++i) {
        if (sides.doubtful[i] != 0)
          decide(packet, i, end[i]);
        else if (packet.triangle[i] != RayPacket::kMiss)
          packet.triangle[i] =
              guard_->pairs[packet.triangle[i]][static_cast<std::size_t>(-sides.second[i])];
      }
    } else {
      // There are no branches: every lane looks a facet up, those without a hit the first.
      for (int i = 0; i < count; ++i) {
        const bool hit = packet.geometry[i] == kFacets;
        const std::uint32_t facet =
            guard_->pairs[hit ? packet.triangle[i] : 0][static_cast<std::size_t>(-sides.second[i])];
        packet.triangle[i] = hit ? facet : packet.triangle[i];
      }
    }
    if (!same_corners_.empty()) choose_facing(packet, count);
  }

  void occluded(RayPacket& packet, int count, bool coherent) const override {
    EmbreeQuery query(coherent);
    alignas(64) int valid[16];
    std::memcpy(valid, kValid + 16 - count, sizeof(valid));
    switch_off_from(packet, count);
    query.occluded(valid, scene_, packet);
  }

  VertexCounts vertex_counts() const override {
    if (guard_ == nullptr) return {};
    return {guard_->near_vertex.load(std::memory_order_relaxed),
            guard_->decided.load(std::memory_order_relaxed)};
  }

 private:
  // Below AVX-512 Embree cuts packets of 16 up and goes by tnear and tfar alone, not by `valid`.
  void switch_off_from(RayPacket& p, int count) const {
    if (takes_sixteen_) return;
    for (int i = count; i < RayPacket::kSize; ++i) {
      p.tnear[i] = 0;
      p.tfar[i] = -1;
    }
  }

  // Where surfaces are closer to each other than a distance from afar is known, finds the nearer
  // one, with rays that begin shortly before the hit.
  void look_again(RayPacket& p, int count, const float* end, EmbreeQuery& query) const {
    constexpr double kBefore = 0x1p-14;  // of the distance: hundreds of its roundings
    alignas(64) int valid[16] = {};
    RayPacket near{};
    double before[16];
    bool any = false;
    for (int i = 0; i < RayPacket::kSize; ++i) {
      near.tfar[i] = -1;
      if (i >= count || p.geometry[i] != kFacets) continue;
      const Point3 d = direction_of(p, i), from = origin_of(p, i);
      const double t = static_cast<double>(p.tfar[i]), start = t * (1 - kBefore);
      if (t * std::hypot(d[0], d[1], d[2]) < kFarM || start < static_cast<double>(p.tnear[i]))
        continue;
      before[i] = start;
      valid[i] = -1;
      any = true;
      near.org_x[i] = static_cast<float>(from[0] + start * d[0]);
      near.org_y[i] = static_cast<float>(from[1] + start * d[1]);
      near.org_z[i] = static_cast<float>(from[2] + start * d[2]);
      near.dir_x[i] = p.dir_x[i];
      near.dir_y[i] = p.dir_y[i];
      near.dir_z[i] = p.dir_z[i];
      near.tfar[i] =
          static_cast<float>(std::min(2 * kBefore * t, static_cast<double>(end[i]) - start));
      near.mask[i] = p.mask[i];
      near.triangle[i] = near.geometry[i] = near.instance[i] = RayPacket::kMiss;
    }
    if (!any) return;
    query.intersect(valid, scene_, near);
    for (int i = 0; i < count; ++i) {
      if (valid[i] == 0 || near.geometry[i] == RTC_INVALID_GEOMETRY_ID) continue;
      p.tfar[i] = static_cast<float>(before[i] + static_cast<double>(near.tfar[i]));
      p.triangle[i] = near.triangle[i];
      p.geometry[i] = near.geometry[i];
      p.u[i] = near.u[i];
      p.v[i] = near.v[i];
      p.normal_x[i] = near.normal_x[i];
      p.normal_y[i] = near.normal_y[i];
      p.normal_z[i] = near.normal_z[i];
    }
  }

  // The true facet of a ray that met a cap or came close to an edge. Two facets that share an edge
  // may both accept a ray within rounding of it, at the same distance: which one Embree then
  // reports depends on the order of its traversal, and that on the packet's other rays. At an
  // outermost edge a facet may accept a ray that passes it by.
  void decide(RayPacket& p, int i, float end) const {
    RTCRayHit one{};
    one.ray.org_x = p.org_x[i];
    one.ray.org_y = p.org_y[i];
    one.ray.org_z = p.org_z[i];
    one.ray.dir_x = p.dir_x[i];
    one.ray.dir_y = p.dir_y[i];
    one.ray.dir_z = p.dir_z[i];
    one.ray.tfar = p.tfar[i];
    one.ray.mask = p.mask[i];
    one.hit.primID = p.triangle[i];
    one.hit.geomID = p.geometry[i];
    one.hit.u = p.u[i];
    one.hit.v = p.v[i];
    for (;;) {
      if (on_needle(one.hit.geomID, one.hit.primID)) {
        put(p, i, exact().nearest(origin_of(p, i), direction_of(p, i), p.tnear[i], end));
        return;
      }
      if (settle(one, p.tnear[i])) break;
      look_behind(one, end);
    }
    p.triangle[i] = one.hit.primID;
    p.geometry[i] = one.hit.geomID;
    p.tfar[i] = one.ray.tfar;
    p.normal_x[i] = one.hit.Ng_x;
    p.normal_y[i] = one.hit.Ng_y;
    p.normal_z[i] = one.hit.Ng_z;
  }

  // Puts the true hit, with its facet's number, in the place of the reported one; false where the
  // ray passes by.
  bool settle(RTCRayHit& one, double t_min) const {
    if (one.hit.geomID == RTC_INVALID_GEOMETRY_ID) return true;
    const bool cap = one.hit.geomID == kCaps, second = one.hit.u + one.hit.v > 1;
    const float u = second ? 1 - one.hit.u : one.hit.u, v = second ? 1 - one.hit.v : one.hit.v;
    if (!cap && std::min({u, v, 1 - u - v}) >= kNearEdge) {
      one.hit.primID = guard_->pairs[one.hit.primID][second ? 1 : 0];
      return true;
    }
    const Point3 origin{one.ray.org_x, one.ray.org_y, one.ray.org_z},
        direction{one.ray.dir_x, one.ray.dir_y, one.ray.dir_z};
    VertexFans::Hit hit;
    if (cap) {
      hit = guard_->fans.nearest(one.hit.primID / 2, origin, direction, t_min);
      guard_->near_vertex.fetch_add(1, std::memory_order_relaxed);
      if (hit.met()) guard_->decided.fetch_add(1, std::memory_order_relaxed);
    } else {
      hit = guard_->fans.nearest_around(guard_->pairs[one.hit.primID][second ? 1 : 0], origin,
                                        direction, t_min);
    }
    // Farther than that it is another place of the surface.
    if (!hit.met() || (!cap && hit.at.t > static_cast<double>(one.ray.tfar) * (1 + kSameDistance)))
      return false;
    if (cap) hit = guard_->fans.nearest_around(hit.facet, origin, direction, t_min);
    const Point3 n = normal_of(hit.facet);
    one.hit.geomID = kFacets;
    one.hit.primID = hit.facet;
    one.ray.tfar = static_cast<float>(hit.at.t);
    one.hit.Ng_x = static_cast<float>(n[0]);
    one.hit.Ng_y = static_cast<float>(n[1]);
    one.hit.Ng_z = static_cast<float>(n[2]);
    return true;
  }

  // The next hit behind one that was none.
  void look_behind(RTCRayHit& one, float end) const {
    one.ray.tnear = std::nextafter(one.ray.tfar, std::numeric_limits<float>::infinity());
    one.ray.tfar = end;
    one.hit.geomID = one.hit.primID = one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    EmbreeQuery(false).intersect(scene_, one);
  }

  const ReferenceTracer& exact() const {
    std::call_once(exact_built_, [&] {
      std::vector<Point3> corner;
      corner.reserve(vertex_.size() / 3);
      for (std::size_t k = 0; k + 2 < vertex_.size(); k += 3)
        corner.push_back({vertex_[k], vertex_[k + 1], vertex_[k + 2]});
      exact_ = std::make_unique<ReferenceTracer>(std::move(corner), triangle_);
    });
    return *exact_;
  }

  static Point3 origin_of(const RayPacket& p, int i) {
    return {p.org_x[i], p.org_y[i], p.org_z[i]};
  }
  static Point3 direction_of(const RayPacket& p, int i) {
    return {p.dir_x[i], p.dir_y[i], p.dir_z[i]};
  }

  void put(RayPacket& p, int i, const ReferenceTracer::Hit& hit) const {
    p.triangle[i] = hit.facet;
    p.geometry[i] = hit.met() ? kFacets : RTC_INVALID_GEOMETRY_ID;
    if (!hit.met()) return;
    const Point3 n = normal_of(hit.facet);
    p.tfar[i] = static_cast<float>(hit.t);
    p.normal_x[i] = static_cast<float>(n[0]);
    p.normal_y[i] = static_cast<float>(n[1]);
    p.normal_z[i] = static_cast<float>(n[2]);
  }

  // `pair`: as the ray tracer reports it.
  bool on_needle(std::uint32_t geometry, std::uint32_t pair) const {
    return geometry == kFacets && !guard_->needle.empty() && guard_->needle[pair];
  }

  // Returns a normal that is not normalised.
  Point3 normal_of(std::uint32_t facet) const {
    const auto corner = [&](std::size_t k) {
      return &vertex_[3 * std::size_t{triangle_[3 * std::size_t{facet} + k]}];
    };
    const float *a = corner(0), *b = corner(1), *c = corner(2);
    const auto across = [&](std::size_t k, std::size_t l) {
      return (static_cast<double>(b[k]) - a[k]) * (static_cast<double>(c[l]) - a[l]) -
             (static_cast<double>(b[l]) - a[l]) * (static_cast<double>(c[k]) - a[k]);
    };
    return {across(1, 2), across(2, 0), across(0, 1)};
  }

  void choose_facing(RayPacket& p, int count) const {
    for (int i = 0; i < count; ++i) {
      if (p.triangle[i] == RayPacket::kMiss) continue;
      const SameCorners::Choice choice = same_corners_.choose(
          p.triangle[i],
          p.normal_x[i] * p.dir_x[i] + p.normal_y[i] * p.dir_y[i] + p.normal_z[i] * p.dir_z[i] < 0);
      p.triangle[i] = choice.facet;
      if (!choice.turned) continue;
      p.normal_x[i] = -p.normal_x[i];
      p.normal_y[i] = -p.normal_y[i];
      p.normal_z[i] = -p.normal_z[i];
    }
  }

  RTCDevice device_;
  RTCScene scene_;
  std::vector<float> vertex_;
  std::vector<std::uint32_t> triangle_;
  mutable std::once_flag exact_built_;
  mutable std::unique_ptr<ReferenceTracer> exact_;  // made when first asked for
  std::unique_ptr<Guard> guard_;
  SameCorners same_corners_;
  bool is_large_;  // enough for rays of kFarM
  bool takes_sixteen_;
};

// A geometry of triangles (three indices) or pairs of triangles (four), attached to the scene. What
// fails is told by the device afterwards.
template <std::size_t kCorners>
void attach(RTCDevice device, RTCScene scene, const std::vector<float>& vertex,
            const std::uint32_t* index, std::size_t count) {
  static_assert(kCorners == 3 || kCorners == 4);
  RTCGeometry geometry = new_unmasked_geometry(
      device, kCorners == 3 ? RTC_GEOMETRY_TYPE_TRIANGLE : RTC_GEOMETRY_TYPE_QUAD);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           3 * sizeof(float), vertex.size() / 3);
  constexpr std::size_t kBytes = kCorners * sizeof(std::uint32_t);
  void* indices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                              kCorners == 3 ? RTC_FORMAT_UINT3 : RTC_FORMAT_UINT4, kBytes, count);
  if (vertices != nullptr && indices != nullptr) {
    std::memcpy(vertices, vertex.data(), vertex.size() * sizeof(float));
    std::memcpy(indices, index, count * kBytes);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
  }
  rtcReleaseGeometry(geometry);
}

// Two pairs of triangles make the tetrahedron of a cap.
std::vector<std::uint32_t> cap_indices(std::uint32_t count) {
  std::vector<std::uint32_t> out;
  out.reserve(8 * std::size_t{count});
  for (std::uint32_t first = 0; first < 4 * count; first += 4)
    for (const std::uint32_t k : {0u, 1u, 2u, 3u, 1u, 2u, 3u, 0u}) out.push_back(first + k);
  return out;
}

// Returns for each pair whether one of its facets is a needle; empty if there is no needle.
std::vector<bool> needle_pairs(const VertexFans& fans,
                               const std::vector<std::array<std::uint32_t, 2>>& pairs) {
  const auto is_needle = [&](std::uint32_t facet) {
    double longest2 = 0, twice_area2 = 0;
    const Point3 a = fans.corner(facet, 0), b = fans.corner(facet, 1), c = fans.corner(facet, 2);
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t k = (j + 1) % 3, l = (j + 2) % 3;
      const double n = (b[k] - a[k]) * (c[l] - a[l]) - (b[l] - a[l]) * (c[k] - a[k]);
      twice_area2 += n * n;
    }
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      double length2 = 0;
      for (std::size_t j = 0; j < 3; ++j) length2 += (p[j] - q[j]) * (p[j] - q[j]);
      longest2 = std::max(longest2, length2);
    }
    return twice_area2 > 0 && longest2 * longest2 > kNeedle * kNeedle * twice_area2;
  };
  std::vector<bool> out(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    out[i] = is_needle(pairs[i][0]) || is_needle(pairs[i][1]);
  if (std::find(out.begin(), out.end(), true) == out.end()) out.clear();
  return out;
}

TracerIsa widest_here() {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return TracerIsa::kAvx512;
  if (__builtin_cpu_supports("avx2")) return TracerIsa::kAvx2;
  return TracerIsa::kSse42;
}

std::atomic<TracerIsa> pinned_isa = TracerIsa::kAvx512;

}  // namespace

TracerIsa widest_isa() { return std::max(widest_here(), pinned_isa.load()); }

absl::Status pin_isa(const std::string& name) {
  for (const TracerIsa isa : {TracerIsa::kAvx512, TracerIsa::kAvx2, TracerIsa::kSse42}) {
    if (isa_name(isa) != name) continue;
    if (isa < widest_here())
      return absl::FailedPreconditionError(absl::StrCat("this machine has no ", name,
                                                        ": its widest instruction set is ",
                                                        isa_name(widest_here())));
    pinned_isa = isa;
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrCat("instruction set \"", name, "\": expected avx512, avx2 or sse4.2"));
}

std::string isa_name(TracerIsa isa) {
  switch (isa) {
    case TracerIsa::kAvx512:
      return "avx512";
    case TracerIsa::kAvx2:
      return "avx2";
    case TracerIsa::kSse42:
      return "sse4.2";
  }
  return "";
}

absl::StatusOr<std::unique_ptr<Tracer>> Tracer::build(const std::vector<float>& vertex,
                                                      const std::vector<std::uint32_t>& triangle,
                                                      TracerIsa isa, TracerOptions options) {
  if (triangle.empty()) return absl::InvalidArgumentError("there is no facet to trace");
  const std::string config = "threads=1,set_affinity=0,isa=" + isa_name(isa);
  RTCDevice device = rtcNewDevice(config.c_str());
  if (device == nullptr) return absl::InternalError("Embree: no device with " + config);
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  // With COMPACT, packets of 16, COHERENT and AVX-512 Embree 3.13.5 loops for ever.
  IRSIG_CHECK((rtcGetSceneFlags(scene) & RTC_SCENE_FLAG_COMPACT) == 0);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);

  SameCorners same_corners({}, {});
  std::unique_ptr<Guard> guard;
  if (options.guard != TracerGuard::kNone) {
    same_corners = SameCorners(vertex, triangle);
    const std::vector<std::uint32_t> traced = same_corners.first_of_each(triangle);
    FacetPairs pairs(vertex, traced);
    attach<4>(device, scene, vertex, pairs.corner().front().data(), pairs.corner().size());
    guard = std::make_unique<Guard>(VertexFans(vertex, traced), pairs.take_facets());
    guard->needle = needle_pairs(guard->fans, guard->pairs);
    if (options.guard == TracerGuard::kVertices) {
      const std::vector<std::uint32_t> cap = cap_indices(guard->fans.count());
      attach<4>(device, scene, guard->fans.cap_corners(kCapReach * radius_of(vertex)), cap.data(),
                cap.size() / 4);
    }
  } else {
    attach<3>(device, scene, vertex, triangle.data(), triangle.size() / 3);
  }
  rtcCommitScene(scene);
  auto tracer = std::make_unique<EmbreeTracer>(device, scene, vertex, triangle, std::move(guard),
                                               std::move(same_corners));
  if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
    return absl::InternalError("Embree: error " + std::to_string(static_cast<int>(error)) +
                               " while building the acceleration structure");
  return tracer;
}

}  // namespace irsig
