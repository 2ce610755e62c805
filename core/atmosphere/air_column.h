#pragma once

#include "core/atmosphere/aerosol.h"
#include "core/atmosphere/air_profile.h"

namespace irsig {

// Computes the vertical optical depth of all particles at a wavelength of sunlight, from the ground
// to 100 km: aerosol_depth_550 by the law of [angstrom1961], extinction ~ wavelength^-1.3 for haze
// over land, ^-0.6 over the sea, ^0 for fog.
[[nodiscard]] double aerosol_depth(const AerosolSpec& spec, double surface_humidity_percent,
                                   double wavelength_nm);

// Returns the ozone above the surface, at standard pressure and temperature. [cm]
[[nodiscard]] double ozone_cm(const AirProfile& profile);

// Returns the pressure of the standard atmosphere below 11 km [ussa1976], and 0 above. [Pa]
[[nodiscard]] double standard_pressure_pa(double height_m);

}  // namespace irsig
