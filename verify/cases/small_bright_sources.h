#pragma once

#include <string>
#include <vector>

#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"

namespace irsig {

// Plates of 16 m2 with one small object that is much brighter, and the same plate without it: they
// measure the benefit of aiming at bright objects (docs/evidence/stability.md).
struct RareLightScene {
  std::string name;
  SceneSpec scene;
  ViewRequest request;  // one condition, all bands
};

// Returns the plate alone, cut into squares of side square_m [m]; 0: two triangles.
[[nodiscard]] RareLightScene plain_plate(bool sun, double square_m = 0);
// Returns a source of 1200 K behind a hole in a wall; side_m = 0: no hole. The second function cuts
// the wall into squares, so that no single triangle hides much.
[[nodiscard]] RareLightScene hot_behind_hole(double side_m);
[[nodiscard]] RareLightScene hot_behind_fine_wall(double side_m, double square_m);
// Returns a mirror that shows the sun; mirror_pair() returns a mirror that shows a second mirror,
// which shows the sun.
[[nodiscard]] RareLightScene small_mirror(double side_m, double slope, bool metal);
[[nodiscard]] RareLightScene mirror_pair(double side_m, double slope, bool metal);

// Returns the scenes on which a goal of 1 % is measured, each with its plain counterpart.
struct SmallBrightSourcePair {
  RareLightScene rare, plain;
};
[[nodiscard]] std::vector<SmallBrightSourcePair> small_bright_source_scenes();

}  // namespace irsig
