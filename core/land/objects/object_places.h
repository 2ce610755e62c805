#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/land/height_field.h"
#include "core/land/land_cover.h"
#include "core/land/objects/land_objects.h"

namespace irsig {

// The rectangle on which a mesh stands, and its lowest point, in the frame of the mesh. [m]
struct ObjectBase {
  double back_m = 0, front_m = 0, port_m = 0, starboard_m = 0;  // of its axes x and y
  double lowest_z_m = 0;                                        // downwards, as z of the body frame
};
[[nodiscard]] ObjectBase base_of(const Mesh& mesh);

// Returns the lowest z of the land at 5 x 5 points of an object's base; nullopt: one of them lies
// beyond the map.
[[nodiscard]] std::optional<double> lowest_land_m(const ObjectBase& base, const ObjectPlace& place,
                                                  const HeightField& field);

// Objects scattered at random over a ring around the target.
struct ObjectScatter {
  std::uint64_t count = 0, seed = 0;
  double inner_radius_m = 0, radius_m = 0;
  std::uint32_t material = 0;  // of the cover; an object stands where this is the ground
  double scale = 1;
};

// Returns `count` places whose base lies on the map, each with a heading of its own. A place is
// taken with the probability that is the fraction of the material there. Equal arguments give equal
// places. INVALID_ARGUMENT: fewer than one of a thousand tries finds a place.
[[nodiscard]] absl::StatusOr<std::vector<ObjectPlace>> scatter_objects(const ObjectScatter& how,
                                                                       const ObjectBase& base,
                                                                       const HeightField& field,
                                                                       const LandCover& cover);

}  // namespace irsig
