// Finds for rays of pictures whether their first hits are in the sun, and which parts stand behind
// them.

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "core/transport/path_work.h"

namespace irsig {

void join_met(std::vector<TracedPictures::Met>& met) {
  std::sort(met.begin(), met.end(), [](const auto& a, const auto& b) {
    return std::pair(a.pixel, a.part) < std::pair(b.pixel, b.part);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (kept > 0 && met[kept - 1].pixel == met[i].pixel && met[kept - 1].part == met[i].part)
      met[kept - 1].samples += met[i].samples;
    else
      met[kept++] = met[i];
  }
  met.resize(kept);
}

// Counts the first hits of the batch that face a sun and are not in the target's own shadow.
void PathTracer::light_first_hits(Work& work) const {
  const ImagePlan& plan = *work.plan;
  const std::size_t numbers = plan.first_numbers(), before_suns = numbers - plan.towards_sun.size();
  RayBatch& batch = work.first_shadow;
  for (std::size_t j = 0; j < plan.towards_sun.size(); ++j) {
    const Float3 direction = to_float(plan.towards_sun[j]);
    batch.size = 0;
    work.first_shadow_pixel.clear();
    for (const Work::FirstHit& hit : work.first_hit) {
      if (!(dot(hit.normal, direction) > 0)) continue;
      batch.push(hit.from, direction, {});
      work.first_shadow_pixel.push_back(hit.pixel);
    }
    const double clear_m =
        land_ == nullptr ? 0 : land_->clear_beyond_m(plan.towards_sun[j], target_.radius_m, 0);
    batch.prepare_packets(false);
    if (!settings_.skip_self_intersection) {
      batch.for_each_packet(
          [&](RayPacket& packet, int count) { target_.tracer->occluded(packet, count, true); });
      work.counts->rays += batch.size;
    }
    for (std::uint32_t i = 0; i < batch.size; ++i)
      if (!(batch.packet_of(i).tfar[RayBatch::lane_of(i)] < 0) &&
          !shaded_by_land(batch, i, clear_m))
        work.pictures->first_sum[work.first_shadow_pixel[i] * numbers + before_suns + j] += 1;
  }
  work.first_hit.clear();
}

// Follows the batch's primary rays through the target. A part counts from whichever side its facets
// are met: the fraction of a pixel that it fills is that of its projection. A ray ends on sea or
// ground, or when it has met all parts.
void PathTracer::meet_parts_behind(Work& work) const {
  const std::size_t words = (parts_ + 63) / 64;
  work.met_parts.assign(work.batch.size * words, 0);
  work.through.clear();
  RayBatch& on = work.through_batch;
  on.size = 0;
  const auto offset_m = static_cast<float>(target_.offset_m());
  const float surface_z_m =
      plane_ ? static_cast<float>(plane_->z_m) + offset_m : std::numeric_limits<float>::infinity();
  const bool horizon = plane_ && plane_->earth_radius_m > 0 && view_.frame.sensor.z > plane_->z_m;
  // Takes what a ray has met; pushes what is left of it. The rays that are pushed take the places
  // of rays that were read before.
  std::size_t kept = 0;
  const auto take = [&](RayBatch& batch, std::uint32_t i, Work::Through last) {
    const RayPacket& packet = batch.packet_of(i);
    const std::uint32_t lane = RayBatch::lane_of(i), triangle = packet.triangle[lane];
    if (triangle == RayPacket::kMiss) return;
    const PathState s = batch.state[i];
    const Float3 d{packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]};
    const float along = packet.tfar[lane];
    const Float3 p{packet.org_x[lane] + along * d.x, packet.org_y[lane] + along * d.y,
                   packet.org_z[lane] + along * d.z};
    if (p.z > surface_z_m || (horizon && hidden_by_sea(p, d, s.inverse_length))) return;
    if (!seen_past_land(p)) return;
    std::uint64_t* bits = work.met_parts.data() + last.ray * words;
    const std::uint32_t part = target_.facet[triangle].part;
    bits[part / 64] |= std::uint64_t{1} << (part % 64);
    std::uint32_t met = 0;
    for (std::size_t w = 0; w < words; ++w)
      met += static_cast<std::uint32_t>(std::popcount(bits[w]));
    if (met == parts_) return;
    // A facet that lies along the ray may be met again: then the next step is longer.
    const float step_m = triangle == last.triangle ? 2 * last.step_m : offset_m,
                step = step_m * s.inverse_length;
    on.push({p.x + step * d.x, p.y + step * d.y, p.z + step * d.z}, d, s);
    work.through.resize(std::max(work.through.size(), kept + 1));
    work.through[kept++] = {last.ray, triangle, step_m};
  };
  for (std::uint32_t i = 0; i < work.batch.size; ++i)
    take(work.batch, i, {i, RayPacket::kMiss, offset_m});
  while (kept > 0) {
    on.prepare_packets(true);
    on.for_each_packet(
        [&](RayPacket& packet, int count) { target_.tracer->intersect(packet, count, true); });
    work.counts->rays += on.size;
    const std::uint32_t rays = on.size;
    on.size = 0;
    kept = 0;
    for (std::uint32_t i = 0; i < rays; ++i) take(on, i, work.through[i]);
  }
  std::vector<TracedPictures::Met> met;
  std::vector<std::uint32_t> parts;
  for (std::uint32_t i = 0; i < work.batch.size; ++i) {
    parts.clear();
    for (std::uint32_t part = 0; part < parts_; ++part)
      if (work.met_parts[i * words + part / 64] >> (part % 64) & 1) parts.push_back(part);
    if (parts.empty()) continue;
    const auto [set, is_new] = work.place_of_set.try_emplace(
        parts, static_cast<std::uint32_t>(work.pictures->part_set.size()));
    if (is_new) work.pictures->part_set.push_back(parts);
    const std::size_t pixel = stored_pixel(*work.plan, pixel_of(work, work.batch.state[i]));
    met.push_back({static_cast<std::uint32_t>(pixel), set->second, 1});
  }
  join_met(met);
  std::vector<TracedPictures::Met>& all = work.pictures->met_set;
  all.insert(all.end(), met.begin(), met.end());
}

}  // namespace irsig
