#pragma once

#include "core/atmosphere/aerosol.h"
#include "core/atmosphere/air_profile.h"

namespace irsig {

// Long-wave radiation that fog sends to the ground, in the middle of the window, where the sky is
// clear without it: emissivity x the radiation of a black body.
struct FogSky {
  double emissivity;  // [0, 1] what the fog does not let pass of the sky's diffuse light
  double colder_k;    // by how much that black body is colder than the air at the ground
};

// Returns the sky of fog that is stated as aerosol: two streams through its layers of 25 m, above a
// black ground as warm as the air. What the fog reflects of the ground counts as emitted. Without
// fog both numbers are 0.
//
// Accuracy: tests/physics/cloud_walls_test.cpp compares the sky that walls have with the hemisphere
// of the view's sky: 3 %.
[[nodiscard]] FogSky fog_sky(const AerosolSpec& aerosol, const AirProfile& profile);

}  // namespace irsig
