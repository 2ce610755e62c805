#pragma once

namespace irsig {

// Bases of clouds that are taken to condense where rising air does: lower ones would be fog.  [m]
inline constexpr double kLowestCondensationM = 300, kHighestCondensationM = 2500;

// Returns the base of a cloud of which nothing is known but the air at the surface: the level of
// condensation within these limits. [m]
[[nodiscard]] double condensed_base_m(double air_k, double relative_humidity_percent);

// Returns the height above the surface at which rising air condenses: the temperature of
// condensation of [bolton1980] (0.1 K), reached at the dry adiabat's 9.76 K/km. [m]
[[nodiscard]] double condensation_level_m(double air_k, double relative_humidity_percent);

// Returns the temperature of rising air at that level. [K]
[[nodiscard]] double condensation_temperature_k(double air_k, double relative_humidity_percent);

// Returns the temperature of air that has risen from the surface to a height: along the dry adiabat
// up to the level of condensation, and above it along the saturated one, in steps of 50 m.  [K]
//   pressure_pa  at the surface
// Accuracy: keeps moist static energy to 0.2 K up to 2.5 km (tests/unit/thermal_test.cpp).
[[nodiscard]] double risen_air_k(double air_k, double relative_humidity_percent, double pressure_pa,
                                 double height_m);

}  // namespace irsig
