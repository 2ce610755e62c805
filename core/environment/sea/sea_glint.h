#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/geo/frames.h"

namespace irsig {

// Sunlight mirrored by a rough sea in one direction: glint_per_sr() of sea_surface.h, and the angle
// of incidence on the facets that do it.
struct SeaGlint {
  float per_sr;         // radiance / (irradiance normal to the beam x reflectance)
  float cos_incidence;  // on the facets
};
// Returns the glint of the sun by facets of the sea; none where a direction does not point upwards.
//   to_observer, to_sun  unit vectors in the body frame (z < 0 is up)
[[nodiscard]] SeaGlint sea_glint(Vec<Body> to_observer, Vec<Body> to_sun, double wind_speed_m_s);

// rho depends on wavelength and on the incidence: paths add their weight to the incidences around
// theirs, rho is put in afterwards. It is taken for linear in (1 - cos)^3 between these: within 2 %
// of rho (tests/physics/sea_glint_test.cpp).
inline constexpr std::array<float, 13> kGlintCosines{
    0, 0.025f, 0.055f, 0.09f, 0.13f, 0.19f, 0.25f, 0.32f, 0.4f, 0.49f, 0.59f, 0.75f, 1};

struct GlintShare {
  std::size_t node;  // and the next
  float weight_of_next;
};
[[nodiscard]] GlintShare glint_fraction(float cos_incidence);

}  // namespace irsig
