#include "core/signature/view_seed.h"

#include "core/signature/view/scene_hash.h"

namespace irsig {

std::uint64_t view_seed(const PreparedScene& scene, const ViewRequest& request) {
  Hash hash;
  hash.add(scene.hash);
  hash.add(request.viewpoint.aspect_azimuth_deg);
  hash.add(request.viewpoint.aspect_elevation_deg);
  hash.add(request.viewpoint.range_m);
  hash.add(request.seed);
  return hash.value();
}

}  // namespace irsig
