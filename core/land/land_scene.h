#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/land/height_field.h"
#include "core/land/land_cover.h"

namespace irsig {

// The land on which a target stands. Its local frame has its origin at the target's place.
struct LandScene {
  std::shared_ptr<const HeightField> field;
  LandCover cover;
  std::vector<std::uint32_t> material;  // [of cover] index in SceneSpec::material
  double heading_deg = 0;               // of the target's bow, clockwise from north
  double surface_m = 0;                 // z of the land below the target
};

}  // namespace irsig
