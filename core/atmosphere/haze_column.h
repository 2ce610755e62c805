#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/atmosphere/two_stream.h"

namespace irsig {

// Light that a column of haze scatters more than once, in one band.
//
// Radiance is a sum over azimuths, sum over m of (2 - [m = 0]) I_m(cosine) cos(m azimuth), whose
// terms are integrated along eight directions, and the phase function is Henyey and Greenstein's.
// Zenith angles and azimuths are those of the direction in which light travels; azimuths count from
// the sun's beam.

inline constexpr std::size_t kHazeMoments = 8, kHazeModes = 4;

// Gauss's cosines of one hemisphere.
inline constexpr std::array kHazeCosines = {0.06943184420297371, 0.33000947820757187,
                                            0.6699905217924281, 0.9305681557970263};

// Legendre's associated functions of one cosine, sqrt((l - m)! / (l + m)!) P_lm, for m below
// kHazeModes and l from m to kHazeMoments - 1, m by m.
class HazeHarmonics {
 public:
  static constexpr std::size_t kCount = 26;
  explicit HazeHarmonics(double cosine);
  [[nodiscard]] double operator[](std::size_t i) const { return value_[i]; }
  // Returns the index of the first function of an azimuth's term.
  [[nodiscard]] static constexpr std::size_t first(std::size_t mode) {
    return mode * kHazeMoments - mode * (mode - 1) / 2;
  }

 private:
  std::array<double, kCount> value_{};
};

struct HazeBoundaries {
  std::array<double, kHazeCosines.size()> down_radiance{};  // on the top, from kHazeCosines
  double up_radiance = 0;     // of the surface, without what it reflects
  double surface_albedo = 0;  // diffuse, [0, 1]
  // The sun's irradiance normal to the beam, on the layers' boundaries from the top down; empty:
  // no sun.
  std::span<const double> beam = {};
  double sun_cosine = 1;  // of its zenith angle, (0, 1]
};

// Radiance that particles at a boundary scatter out of diffuse light, per unit of their scattering
// depth: the sum of terms as above, with I_m(cosine) = sum over l of harmonic x
// HazeHarmonics(cosine), and around the sun peak x the phase function of `peak_asymmetry` (its
// integral over all directions is 1).
struct HazeSource {
  std::array<double, HazeHarmonics::kCount> harmonic{};
  double peak = 0, peak_asymmetry = 0;
};

// Returns the light scattered at the layers' boundaries, from the top down. Light that comes
// straight from the sun is not part of it.
//
// Successive orders, begun with two streams' light (core/atmosphere/two_stream.h): four times the
// source is integrated through all layers, linear in optical depth inside a layer, the beam
// exponential. Moments of the phase function beyond kHazeMoments stay in the beam [joseph1976],
// and are given back as a peak whose moments are those of light that goes the beam's way:
// g^l (exp(X g^l) - 1), with the scattering depth X along the beam.
//
// Without sun, in an isothermal column between black bodies of its temperature, the source is
// Planck's function. Accuracy: tests/physics/haze_light_test.cpp compares skies with photons
// followed one by one.
//
//   layers  with the asymmetry of the whole phase function
[[nodiscard]] std::vector<HazeSource> haze_sources(std::span<const StreamLayer> layers,
                                                   const HazeBoundaries& boundaries);

}  // namespace irsig
