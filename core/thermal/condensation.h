#pragma once

namespace irsig {

// Returns the height above the surface at which rising air condenses: the temperature of
// condensation of [bolton1980] (0.1 K), reached at the dry adiabat's 9.76 K/km. [m]
[[nodiscard]] double condensation_level_m(double air_k, double relative_humidity_percent);

// Returns the temperature of rising air at that level. [K]
[[nodiscard]] double condensation_temperature_k(double air_k, double relative_humidity_percent);

}  // namespace irsig
