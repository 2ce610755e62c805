#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "core/land/land_scene.h"
#include "core/land/objects/land_objects.h"
#include "core/scene/trace/packet_scene.h"

namespace irsig {

// The land of a sweep with its objects, for packets of rays in the land's local frame. Heights are
// raised by one bend (Land). Another sensor's bend moves land at distance r [m] by the difference
// of the bends times r^2.
// Limits: float32 places land 50 km away within 4 mm; a ray within that distance of an edge may
// miss it.
class LandRays {
 public:
  // Makes the rays of land. land: must outlive the rays. INTERNAL: as PacketScene::make.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<const LandRays>> make(const LandScene& land,
                                                                            double bend_per_m);

  [[nodiscard]] double bend_per_m() const { return bend_per_m_; }
  [[nodiscard]] const PacketScene& scene() const { return *scene_; }
  // Sets the materials of land at a hit of the scene: fractions of materials and kinds.
  //   instance, triangle  of the packet
  //   normal              of length 1, upwards or towards the ray
  void mix_at(std::uint32_t instance, std::uint32_t triangle, double x_m, double y_m,
              Vec<Enu> normal, LandMix& mix) const;

 private:
  LandRays(const LandScene& land, double bend_per_m) : land_(land), bend_per_m_(bend_per_m) {}

  const LandScene& land_;
  double bend_per_m_;
  std::unique_ptr<const PacketScene> scene_;
};

}  // namespace irsig
