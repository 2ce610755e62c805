// Finds the hits of a frame's rays on land and on objects of it, and their light.
#include <algorithm>
#include <cmath>

#include "live/frame_view.h"
#include "live/ray_lane.h"

namespace irsig {
namespace {

// Returns whether two samples of a pixel met the same land at about the same place.
bool is_beside(const FrameView::Sample& a, const FrameView::Sample& b) {
  constexpr double kSamePlace = 0.05;  // of the range
  return a.thing == b.thing && std::abs(a.range_m - b.range_m) < kSamePlace * b.range_m;
}

Vec<Enu> land_normal(const RayPacket& land, std::uint32_t lane) {
  Vec<Enu> n = normalized(Vec<Enu>{land.normal_x[lane], land.normal_y[lane], land.normal_z[lane]});
  const bool turn = land.instance[lane] == PacketScene::kGround
                        ? n.z < 0
                        : n.x * static_cast<double>(land.dir_x[lane]) +
                                  n.y * static_cast<double>(land.dir_y[lane]) +
                                  n.z * static_cast<double>(land.dir_z[lane]) >
                              0;
  return turn ? -1.0 * n : n;
}

}  // namespace

Vec<Enu> FrameView::turned(Vec<Body> d) const {
  return {d.x * land_frame_.sin_heading + d.y * land_frame_.cos_heading,
          d.x * land_frame_.cos_heading - d.y * land_frame_.sin_heading, -d.z};
}

Vec<Enu> FrameView::place_of(Vec<Body> p) const {
  const Vec<Enu> level = turned({p.x + target_.centre.x, p.y + target_.centre.y, 0});
  return {level.x, level.y, land_frame_.surface_m - p.z};
}

Vec<Enu> FrameView::in_sight(Vec<Body> d) const {
  Vec<Enu> out = turned(d);
  out.z += dot(land_frame_.slope, out);
  return out;
}

void FrameView::trace_land(const Vec<Body>* direction, FrameWorker& worker) const {
  for (std::uint32_t p = 0; p < kTilePixels / RayPacket::kSize; ++p) {
    RayPacket& packet = worker.land[p];
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const Vec<Enu> d =
          in_sight(direction[p * RayPacket::kSize + static_cast<std::uint32_t>(lane)]);
      set_ray(packet, lane, land_frame_.sensor, d);
    }
    rays_->scene().intersect(packet, RayPacket::kSize);
  }
}

bool FrameView::shade_land(Vec<Body> d, FrameWorker& worker, std::uint32_t i, Sample& out) const {
  const RayPacket& land = worker.land[i / RayPacket::kSize];
  const std::uint32_t lane = i % RayPacket::kSize;
  if (land.triangle[lane] == RayPacket::kMiss) return false;
  LandMix& mix = worker.mix;
  const auto distance = static_cast<double>(land.tfar[lane]);
  const Vec<Enu> n = land_normal(land, lane), at_m = land_frame_.sensor + distance * in_sight(d);
  rays_->mix_at(land.instance[lane], land.triangle[lane], at_m.x, at_m.y, n, mix);
  const Land::RangeShare range = land_->behind(distance);
  const auto ranges = static_cast<std::uint32_t>(of_.land_range_m.size());
  const auto at = [&](const std::vector<float>& table, std::uint32_t row) {
    const float* v = table.data() + row * ranges + range.node;
    return v[0] + range.weight_of_next * (v[1] - v[0]);
  };
  const float open = static_cast<float>(std::min(1.0, 0.5 * (1 + n.z)));
  float emitted = 0, sun = 0;
  for (const KindShare& part : mix.kind)
    emitted += open * part.share * at(seen_.light.land, part.kind);
  std::uint32_t most = 0;
  for (std::uint32_t m = 0; m < mix.fraction.size(); ++m) {
    if (mix.fraction[m] > mix.fraction[most]) most = m;
    if (!(mix.fraction[m] > 0)) continue;
    if (open < 1) emitted += (1 - open) * mix.fraction[m] * at(seen_.light.land, of_.kinds + m);
    if (of_.sun_shines) sun += mix.fraction[m] * at(seen_.light.land_sun, m);
  }
  out.light = total_of(emitted, 0, 0, seen_.light.path);
  out.met = static_cast<LiveClass>(1 + 2 * (of_.materials + most));
  out.thing = (1u << 16) | most;
  out.range_m = distance;
  worker.sun_of[i] = sun * static_cast<float>(std::max(0.0, dot(n, land_frame_.sun)));
  return true;
}

void FrameView::add_sun_on_land(FrameWorker& worker, const Vec<Body>* direction,
                                const Sample* before, Sample* out) const {
  for (std::uint32_t p = 0; p < kTilePixels / RayPacket::kSize; ++p) {
    const RayPacket& land = worker.land[p];
    RayPacket& ray = worker.to_sun;
    int count = 0;
    std::uint32_t of[RayPacket::kSize];
    for (std::uint32_t lane = 0; lane < RayPacket::kSize; ++lane) {
      const std::uint32_t i = p * RayPacket::kSize + lane;
      if (land.triangle[lane] == RayPacket::kMiss || !(worker.sun_of[i] > 0)) continue;
      if (before != nullptr && is_beside(before[i], out[i])) {
        if (before[i].met == out[i].met + 1) add_sun_to(worker.sun_of[i], out[i]);
        continue;
      }
      // Coordinates of float32 are known to 2^-24 of the farthest of them.
      constexpr double kDepart = 0x1p-20;
      const auto distance = static_cast<double>(land.tfar[lane]);
      const Vec<Enu> at = land_frame_.sensor + distance * in_sight(direction[i]),
                     n = land_normal(land, lane);
      const double off = kDepart * (distance + length(at)) + 1e-4;
      set_ray(ray, count, at + off * n, land_frame_.sun);
      of[count++] = i;
    }
    if (count == 0) continue;
    rays_->scene().occluded(ray, count);
    int lit = 0;
    for (int k = 0; k < count; ++k)
      if (!(ray.tfar[k] < 0)) of[lit++] = of[k];
    add_sun_past_target(worker, direction, of, lit, out);
  }
}

void FrameView::add_sun_past_target(FrameWorker& worker, const Vec<Body>* direction,
                                    const std::uint32_t* of, int count, Sample* out) const {
  RayPacket& ray = worker.to_sun;
  const Vec<Body> lift{0, 0, target_.offset_m()};
  const double radius_m = target_.radius_m;
  std::uint32_t near[RayPacket::kSize];
  int rays = 0;
  for (int k = 0; k < count; ++k) {
    const Vec<Body> from = frame_.sensor + out[of[k]].range_m * direction[of[k]] - lift;
    // Most rays pass the sphere around the target.
    const double along = -dot(from, of_.sun);
    const Vec<Body> nearest = from + along * of_.sun;
    if (along < -radius_m || dot(nearest, nearest) > radius_m * radius_m) {
      add_sun_to(worker.sun_of[of[k]], out[of[k]]);
      continue;
    }
    set_ray(ray, rays, from, Vec<Body>{sun_.x, sun_.y, sun_.z});
    near[rays++] = of[k];
  }
  if (rays == 0) return;
  target_.tracer->occluded(ray, rays, true);
  for (int k = 0; k < rays; ++k)
    if (!(ray.tfar[k] < 0)) add_sun_to(worker.sun_of[near[k]], out[near[k]]);
}

}  // namespace irsig
