#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "core/geo/frames.h"

namespace irsig {

// Mean square slope of a clean sea surface, upwind + crosswind, taken isotropic: [cox1954, clean
// sea]
//   0.003 + 0.00512 wind
//   wind_speed_m_s at 12.5 m. Above 20 the slopes are held at those of 20: what they would be more
//   by the same line is part of the model errors.
inline constexpr double kMostSlopeWindMS = 20;
[[nodiscard]] double sea_slope_variance(double wind_speed_m_s);

// Returns the complex refractive index of sea water (1.33 + 0i and so on), 2.5-16 um: pure water's
// at 25 C, from the material library's sea_water. [hale1973]
[[nodiscard]] std::complex<double> sea_water_index(double lambda_um);

// Returns the unpolarised Fresnel reflectance of water at an angle of incidence.
[[nodiscard]] double water_reflectance(std::complex<double> index, double cos_incidence);

// Refractive indices of water at many wavelengths.
struct WaterSpectrum {
  std::vector<double> real, imaginary;  // of the index squared
};
[[nodiscard]] WaterSpectrum sea_water_spectrum(const std::vector<double>& lambda_um);
// Writes the unpolarised Fresnel reflectance of water at the wavelengths first, first + 1, ...
void water_reflectance(const WaterSpectrum& water, double cos_incidence, std::size_t first,
                       std::span<double> out);

// The slopes through which a rough sea is seen from one direction: facets weighted by their share
// of what is seen (their projected area, hidden ones left out).
//
// The mean emissivity is the sum of share (1 - reflectance), within 2e-3 of the integral over
// slopes: at 10 um, 5 m/s and 85 deg from the zenith 0.679 (flat: 0.454). [masuda1988] Facets hide
// each other only by facing away: no shadows, which lower emissivity within a few degrees of the
// horizon.
struct SeaFacet {
  double share;          // adds up to 1
  double cos_incidence;  // on the facet
  Vec<Body> mirrored;  // where the facet mirrors the line of sight to (unit vector, z < 0: the sky)
};
// Returns the facets of a rough sea that an observer sees.
//   to_observer  unit vector from the sea towards the observer, z < 0
[[nodiscard]] std::vector<SeaFacet> sea_facets(Vec<Body> to_observer, double wind_speed_m_s);
// Returns one level facet.
[[nodiscard]] std::vector<SeaFacet> flat_sea(Vec<Body> to_observer);

// Returns the sunlight mirrored by the facets with the right slope, per unit of irradiance normal
// to the beam and of reflectance: P(slope) / (4 n_z^4 projected area). [1/sr]
[[nodiscard]] double glint_per_sr(Vec<Body> to_observer, Vec<Body> to_sun, double wind_speed_m_s);

// Returns one sigma of glint_per_sr(), relative. The first part is the slopes' variance, 0.004
// [cox1954] (above 20 m/s and 0.00512 for each m/s more). The second part is sunlight lost to waves
// that stand in the shadow of others, which glint_per_sr() leaves out: L_sun / (1 + L_observer +
// L_sun) with the shadowing function L of Gaussian slopes [smith1967]. (Hiding from the observer is
// included: the projected area is that of facets towards him.) 0.07 with sun and observer at 30 deg
// and 5 m/s, 0.3 at 2 deg. Limits: uncorrelated heights; swell.
[[nodiscard]] double glint_model_relative(Vec<Body> to_observer, Vec<Body> to_sun,
                                          double wind_speed_m_s);

// Returns the area of the facets that face the observer, projected towards the observer, per area
// of sea: cos(zenith) as long as none face away.
[[nodiscard]] double sea_projected_area(double cos_zenith, double wind_speed_m_s);

}  // namespace irsig
