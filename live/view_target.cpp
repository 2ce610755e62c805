// Finds the hits of a frame's rays on the target, and their light.
#include <algorithm>
#include <cmath>

#include "live/frame_view.h"
#include "live/ray_lane.h"

namespace irsig {
namespace {

bool reject(RayPacket& packet, std::uint32_t lane) {
  packet.triangle[lane] = RayPacket::kMiss;
  return false;
}

Float3 point(const RayPacket& packet, std::uint32_t lane) {
  const float t = packet.tfar[lane];
  return {packet.org_x[lane] + t * packet.dir_x[lane], packet.org_y[lane] + t * packet.dir_y[lane],
          packet.org_z[lane] + t * packet.dir_z[lane]};
}

// Returns the azimuth of the sensor around a normal, from uphill. 0 .. pi
float azimuth_around(Vec<Body> n, Vec<Body> o) {
  const Vec<Body> up{0, 0, -1};
  const Vec<Body> hill = up - dot(up, n) * n, across = o - dot(o, n) * n;
  const double size = length(hill) * length(across);
  if (!(size > 1e-9)) return 0;
  return static_cast<float>(std::acos(std::clamp(dot(hill, across) / size, -1.0, 1.0)));
}

}  // namespace

void FrameView::trace_target(const Vec<Body>* direction, FrameWorker& worker) const {
  for (std::uint32_t p = 0; p < kTilePixels / RayPacket::kSize; ++p) {
    RayPacket& packet = worker.packet[p];
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const Vec<Body> d = direction[p * RayPacket::kSize + static_cast<std::uint32_t>(lane)];
      const double along = pictures_.plane_m / std::max(dot(d, frame_.forward), 1e-6);
      const Vec<Body> from = frame_.sensor + along * d;
      set_ray(packet, lane, from, d);
    }
    target_.tracer->intersect(packet, RayPacket::kSize, true);
  }
}

bool FrameView::shade_target(Vec<Body> d, FrameWorker& worker, std::uint32_t i, Sample& out) const {
  RayPacket& packet = worker.packet[i / RayPacket::kSize];
  const std::uint32_t lane = i % RayPacket::kSize;
  if (packet.triangle[lane] == RayPacket::kMiss) return false;
  const Float3 at = point(packet, lane);
  if (plane_) {
    const Vec<Body> p{at.x, at.y, at.z};
    if (p.z > plane_->z_m || hidden_by(*plane_, p, frame_.sensor)) return reject(packet, lane);
  }
  const std::uint32_t facet_index = packet.triangle[lane];
  const Target::Facet& facet = target_.facet[facet_index];
  Vec<Body> n{facet.nx, facet.ny, facet.nz};
  double cosine = -dot(n, d);
  if (cosine <= 0) {
    if (!target_.part[facet.part].two_sided) return reject(packet, lane);
    n = -1.0 * n;
    cosine = -cosine;
  }
  const double range_m = length(Vec<Body>{at.x, at.y, at.z} - frame_.sensor);
  if (rays_ != nullptr) {
    RayPacket& land = worker.land[i / RayPacket::kSize];
    if (land.triangle[lane] != RayPacket::kMiss &&
        static_cast<double>(land.tfar[lane]) < range_m - target_.offset_m())
      return reject(packet, lane);
    land.triangle[lane] = RayPacket::kMiss;
  }
  const std::uint32_t material = target_.part[facet.part].material;
  const auto cos_o = static_cast<float>(std::min(cosine, 1.0));
  const std::uint32_t emitter =
      emitters_ != nullptr ? emitters_->of(facet_index, facet.part) : facet.part;
  const ConditionSources::EmitterShare& share = of_.emitter[emitter];
  const float* table = seen_.light.emitted.data() + material * of_.lights * kEmissionCosines;
  float emitted = 0;
  for (std::uint32_t k = 0; k < share.count; ++k)
    emitted += static_cast<float>(share.weight[k]) *
               at_cosine(table + (share.first + k) * kEmissionCosines, cos_o);
  float reflected =
      ReflectedSky::look_up(seen_.light.reflected.data() + material * ReflectedSky::kEntries,
                            static_cast<float>(-n.z), cos_o, azimuth_around(n, -1.0 * d));
  if (!own_.facet.empty() && own_.facet[facet_index].hidden > 0) {
    const OwnParts::Facet& own = own_.facet[facet_index];
    reflected += own.hidden * (own_part(own.emitter, table, cos_o) - reflected);
    if (!of_.own_sun.empty())
      reflected += of_.own_sun[facet_index] *
                   at_cosine(seen_.light.sun_reflected.data() + material * kEmissionCosines, cos_o);
  }
  out.light = total_of(emitted, 0, reflected, seen_.light.path);
  out.met = static_cast<LiveClass>(1 + 2 * material);
  out.thing = 1 + facet.part;
  out.range_m = range_m;
  out.temperature_k = static_cast<double>(of_.kelvin[emitter]);
  return true;
}

float FrameView::own_part(std::uint32_t emitter, const float* table, float cos_o) const {
  if (!parts_) return 0;
  const ConditionSources::EmitterShare& share = of_.emitter[emitter];
  // That part sends its emission and some of the sky, as upright walls seen aslant do.
  constexpr float kAslant = 0.7f, kUpright = 0, kSideways = 1.6f;
  const std::uint32_t part = emitters_ != nullptr ? emitters_->part_of(emitter) : emitter,
                      material = target_.part[part].material;
  const float* own = seen_.light.emitted.data() + material * of_.lights * kEmissionCosines;
  float reflected = 0, blackbody = 0, emitted = 0;
  for (std::uint32_t k = 0; k < share.count; ++k) {
    const auto weight = static_cast<float>(share.weight[k]);
    const std::uint32_t light = share.first + k;
    blackbody += weight * seen_.light.blackbody[light];
    emitted += weight * at_cosine(own + light * kEmissionCosines, kAslant);
    reflected += weight * (seen_.light.blackbody[light] -
                           at_cosine(table + light * kEmissionCosines, cos_o));
  }
  if (!(blackbody > 0)) return 0;
  emitted += ReflectedSky::look_up(seen_.light.reflected.data() + material * ReflectedSky::kEntries,
                                   kUpright, kAslant, kSideways);
  return reflected * emitted / blackbody;
}

void FrameView::add_sun(FrameWorker& worker, Sample* out) const {
  for (std::uint32_t p = 0; p < kTilePixels / RayPacket::kSize; ++p) {
    const RayPacket& packet = worker.packet[p];
    RayPacket& ray = worker.to_sun;
    int count = 0;
    std::uint32_t lane_of[RayPacket::kSize];
    for (std::uint32_t lane = 0; lane < RayPacket::kSize; ++lane) {
      if (packet.triangle[lane] == RayPacket::kMiss) continue;
      const Float3 n = facing(packet, lane);
      if (!(dot(n, sun_) > 0)) continue;
      const Float3 at = point(packet, lane);
      const auto offset = static_cast<float>(target_.offset_m());
      set_ray(ray, count, Vec<Body>{at.x + offset * n.x, at.y + offset * n.y, at.z + offset * n.z},
              Vec<Body>{sun_.x, sun_.y, sun_.z});
      lane_of[count++] = lane;
    }
    if (count == 0) continue;
    target_.tracer->occluded(ray, count, true);
    int lit = 0;
    for (int k = 0; k < count; ++k)
      if (!(ray.tfar[k] < 0)) lane_of[lit++] = lane_of[k];
    if (rays_ != nullptr) lit = past_land(packet, lane_of, lit, ray);
    for (int k = 0; k < lit; ++k)
      add_sun_to(reflected_sun(packet, lane_of[k], worker), out[p * RayPacket::kSize + lane_of[k]]);
  }
}

int FrameView::past_land(const RayPacket& packet, std::uint32_t* lane_of, int count,
                         RayPacket& ray) const {
  for (int k = 0; k < count; ++k) {
    const Float3 at = point(packet, lane_of[k]), n = facing(packet, lane_of[k]);
    const double offset = target_.offset_m();
    set_ray(ray, k,
            place_of(Vec<Body>{at.x + offset * n.x, at.y + offset * n.y, at.z + offset * n.z}),
            land_frame_.sun);
  }
  if (count > 0) rays_->scene().occluded(ray, count);
  int lit = 0;
  for (int k = 0; k < count; ++k)
    if (!(ray.tfar[k] < 0)) lane_of[lit++] = lane_of[k];
  return lit;
}

Float3 FrameView::facing(const RayPacket& packet, std::uint32_t lane) const {
  const Target::Facet& f = target_.facet[packet.triangle[lane]];
  const float along =
      f.nx * packet.dir_x[lane] + f.ny * packet.dir_y[lane] + f.nz * packet.dir_z[lane];
  return along > 0 ? Float3{-f.nx, -f.ny, -f.nz} : Float3{f.nx, f.ny, f.nz};
}

float FrameView::reflected_sun(const RayPacket& packet, std::uint32_t lane,
                               FrameWorker& worker) const {
  const Float3 n = facing(packet, lane);
  const Vec<Body> normal{n.x, n.y, n.z},
      o{-packet.dir_x[lane], -packet.dir_y[lane], -packet.dir_z[lane]}, h = normalized(o + of_.sun);
  const double cos_h = std::clamp(dot(h, normal), 1e-6, 1.0);
  const Reflection r{static_cast<float>(dot(normal, of_.sun)), static_cast<float>(dot(normal, o)),
                     static_cast<float>(cos_h), static_cast<float>(1 - cos_h * cos_h),
                     static_cast<float>(std::clamp(dot(h, o), 0.0, 1.0))};
  const Target::Facet& f = target_.facet[packet.triangle[lane]];
  const Material& material = scene_.carried_material()[target_.part[f.part].material];
  if (scene_.path_basis() == nullptr) return material.brdf_per_sr(r) * r.cos_i * seen_.light.sun[0];
  worker.brdf.resize(material.nodes());
  material.spectral_brdf_per_sr(r, worker.brdf.data());
  float sum = 0;
  for (std::uint32_t k = 0; k < of_.columns; ++k)
    sum += worker.brdf[of_.first_column + k] * seen_.light.sun[k];
  return sum * r.cos_i;
}

}  // namespace irsig
