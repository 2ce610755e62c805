#pragma once

#include <numbers>

namespace irsig {

// Exact by definition of the SI.                                           [codata2018]
inline constexpr double kPlanckJS = 6.62607015e-34;
inline constexpr double kLightSpeedMS = 299792458.0;
inline constexpr double kBoltzmannJK = 1.380649e-23;
inline constexpr double kGasConstantJMolK = 8.31446261815324;  // k times the Avogadro constant

// First and second radiation constants for wavelengths in um, the exact quotients of the above
// rounded once to double (a product of rounded factors is off by up to 3 units in the last place,
// which exp(c2 / (lambda T)) would magnify by its exponent).
inline constexpr double kC1LWUm4M2Sr = 1.1910429723971884e8;  // 2 h c^2      [W um^4 m^-2 sr^-1]
inline constexpr double kC2UmK = 1.4387768775039338e4;        // h c / k      [um K]

// Stefan-Boltzmann constant, 2 pi^5 k^4 / (15 h^3 c^2), rounded once.   [W m^-2 K^-4]
inline constexpr double kStefanBoltzmannWM2K4 = 5.6703744191844294e-8;

inline constexpr double kAstronomicalUnitM = 149597870700.0;  // exact       [iau2012_b2]
inline constexpr double kSolarRadiusM = 6.957e8;              // nominal     [iau2015_b3]

inline constexpr double kStandardGravityMS2 = 9.80665;         // exact       [bipm_si]

// The Earth as a sphere: mean radius of GRS 80.                             [moritz2000]
inline constexpr double kEarthRadiusM = 6371008.8;

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

}  // namespace irsig
