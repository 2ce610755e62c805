#pragma once

#include <array>

#include "core/plume/march.h"

namespace irsig {

// Corners of a box in the body frame outside of which there is no gas: what rays are aimed at. It
// is the box of the voxels that hold gas on the grid's own axes, half a voxel (kConstant) or one
// (kLinear) wider.
[[nodiscard]] std::array<Vec<Body>, 8> gas_corners(const PlumeField& field);

// The rectangle across a direction that holds the box, for parallel rays.
struct GasWindow {
  Vec<Body> center, right, up;  // m; directions of length 1, across the direction and each other
  double half_width_m = 0, half_height_m = 0;
  double front_m = 0, back_m = 0;  // along the direction, from center
};
[[nodiscard]] GasWindow gas_window(const PlumeField& field, Vec<Body> direction);

// Projected area of the gas whose grey optical depth along a direction is above a threshold.
struct ProjectedGas {
  double area_m2 = 0, stderr_m2 = 0;
};
// Computes the area from rays_across^2 parallel rays on a lattice over the window, at middles of
// its pixels. stderr_m2: each pixel that the edge crosses contributes a uniform error of half a
// pixel either way.
[[nodiscard]] ProjectedGas projected_gas(const PlumeField& field, Vec<Body> direction,
                                         const GreyAbsorption& grey, double threshold,
                                         int rays_across = 200);

}  // namespace irsig
