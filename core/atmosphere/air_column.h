#pragma once

#include "core/atmosphere/aerosol.h"
#include "core/atmosphere/air_profile.h"

namespace irsig {

// Vertical optical depth of all particles at a wavelength of sunlight, from the ground to 100 km:
// aerosol_depth_550 by the law of [angstrom1961], extinction ~ wavelength^-1.3 for haze of the land,
// ^-0.6 for that of the sea, ^0 for fog.
[[nodiscard]] double aerosol_depth(const AerosolSpec& spec, double surface_humidity_percent,
                                   double wavelength_nm);

// Ozone above the surface, at standard pressure and temperature.                        [cm]
[[nodiscard]] double ozone_cm(const AirProfile& profile);

// Pressure of the standard atmosphere below 11 km [ussa1976]; 0 where its formula ends. [Pa]
[[nodiscard]] double standard_pressure_pa(double height_m);

}  // namespace irsig
