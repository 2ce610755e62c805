#pragma once

#include <array>
#include <complex>
#include <cstddef>

#include "core/geo/frames.h"

namespace irsig {

// Sums of one beam that a rough sea mirrors, by the cosine of the incidence on the facets in equal
// steps; reflectances are applied afterwards. Private to core/environment, as all of this header.
inline constexpr std::size_t kIncidences = 24;
using Incidences = std::array<double, kIncidences>;

// Returns the largest reflectance within a step: water reflects more where it is flatter.
[[nodiscard]] double largest_reflectance(std::complex<double> index, std::size_t step);

// Integrates glint_per_sr over all directions above the sea, and returns the largest of any. [1;
// 1/sr]
//   to_light  unit vector; of light from below the horizon z > 0
// Accuracy: 1 %; 0.1 % (tests/physics/environment_bounds_test.cpp).
[[nodiscard]] Incidences mirrored_in_all(Vec<Body> to_light, double wind_speed_m_s);
[[nodiscard]] Incidences largest_mirrored(Vec<Body> to_light, double wind_speed_m_s);

}  // namespace irsig
