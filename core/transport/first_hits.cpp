// What the first hits of pictures' rays say about a target beside its light.

#include "core/transport/path_work.h"

namespace irsig {

// Counts the first hits of the batch that face a sun and are not in the target's own shadow.
void PathTracer::light_first_hits(Work& work) const {
  const ImagePlan& plan = *work.plan;
  const std::size_t numbers = plan.first_numbers(),
                    before_suns = numbers - plan.towards_sun.size();
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
    batch.prepare_packets(false);
    if (!settings_.skip_self_intersection) {
      batch.for_each_packet(
          [&](RayPacket& packet, int count) { target_.tracer->occluded(packet, count, true); });
      work.counts->rays += batch.size;
    }
    for (std::uint32_t i = 0; i < batch.size; ++i)
      if (!(batch.packet_of(i).tfar[RayBatch::lane_of(i)] < 0))
        work.pictures->first_sum[work.first_shadow_pixel[i] * numbers + before_suns + j] += 1;
  }
  work.first_hit.clear();
}

}  // namespace irsig
