#include "core/transport/target_shadow.h"

#include "core/transport/path_work.h"

namespace irsig {

TargetShadow::TargetShadow(const Target& target) : target_(target) { batch_.resize(1, 0); }

bool TargetShadow::falls_on(Vec<Body> place, Vec<Body> direction) {
  // Most rays pass the sphere around the target.
  const double along = -dot(place, direction);
  const Vec<Body> nearest = place + along * direction;
  const double radius_m = target_.radius_m;
  if (along < -radius_m || dot(nearest, nearest) > radius_m * radius_m) return false;
  batch_.size = 0;
  batch_.push(to_float(place), to_float(direction), {});
  batch_.prepare_packets(false);
  batch_.for_each_packet(
      [&](RayPacket& packet, int count) { target_.tracer->occluded(packet, count, true); });
  return batch_.packet_of(0).tfar[0] < 0;
}

}  // namespace irsig
