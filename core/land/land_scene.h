#pragma once

#include <memory>
#include <vector>

#include "core/land/height_field.h"
#include "core/land/land_cover.h"
#include "core/land/land_kinds.h"
#include "core/land/map_edge.h"

namespace irsig {

class LandObjects;

// The land on which a target stands. Its local frame has its origin at the target's place. The
// materials of the cover are those of SceneSpec::land_material.
struct LandScene {
  std::shared_ptr<const HeightField> field;
  std::shared_ptr<const LandObjects> objects = nullptr;  // that stand on it; null: none
  LandCover cover;
  // Kinds of land whose temperatures are computed; null: each material is one kind.
  std::shared_ptr<const LandKinds> kinds = nullptr;
  double heading_deg = 0;  // of the target's bow, clockwise from north
  double surface_m = 0;    // z of the land below the target
  // Where the map ends in a step: edge_steps(). They are checked against what views see, and are no
  // part of what rays meet.
  std::vector<EdgeStep> edge_step = {};
};

}  // namespace irsig
