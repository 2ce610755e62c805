#pragma once

namespace irsig {

// Bases of clouds of which nothing is known but the air at the surface. Lower clouds would be fog.
// Bases between both limits had 49 % (Denver) and 69 % (San Francisco) of the ceilings below.  [m]
inline constexpr double kLowestCondensationM = 300, kHighestCondensationM = 2500;

// Such a base over the level of condensation of the air at the surface. Rising air condenses there
// if it is mixed from the surface up; over an inversion and in stable air, which are colder or
// moister at the surface than above, clouds are higher.
//
// Source: ceilings observed in the 2493 overcast hours (10 tenths opaque) of Denver's and San
// Francisco's typical years [wilcox2008]. Both stations' median ratio is 2, within 0.01, where the
// limits above hold for the ceiling and for twice the level (tests/unit/thermal_test.cpp).
inline constexpr double kBaseOverCondensation = 2;

// Returns the base of such a cloud: kBaseOverCondensation times the level of condensation, within
// these limits. [m]
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
