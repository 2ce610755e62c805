#pragma once

#include <cstdint>
#include <limits>

#include "core/geo/frames.h"
#include "core/scene/trace/packet_scene.h"

namespace irsig {

// Sets a ray of a packet that has met nothing yet: from a place on, without an end.
template <typename Frame>
void set_ray(RayPacket& packet, int lane, Vec<Frame> from, Vec<Frame> direction) {
  packet.org_x[lane] = static_cast<float>(from.x);
  packet.org_y[lane] = static_cast<float>(from.y);
  packet.org_z[lane] = static_cast<float>(from.z);
  packet.dir_x[lane] = static_cast<float>(direction.x);
  packet.dir_y[lane] = static_cast<float>(direction.y);
  packet.dir_z[lane] = static_cast<float>(direction.z);
  packet.tnear[lane] = packet.time[lane] = 0;
  packet.tfar[lane] = std::numeric_limits<float>::infinity();
  packet.mask[lane] = 0xffffffffu;
  packet.id[lane] = static_cast<std::uint32_t>(lane);
  packet.flags[lane] = 0;
  packet.triangle[lane] = packet.geometry[lane] = packet.instance[lane] = RayPacket::kMiss;
}

}  // namespace irsig
