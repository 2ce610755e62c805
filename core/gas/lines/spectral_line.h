#pragma once

#include <vector>

namespace irsig {

// A line at one temperature, for natural abundances.
struct SpectralLine {
  double centre_cm1;
  double strength;       // [cm-1 / (molecule cm-2)]
  double width_cm1_atm;  // Lorentz, half at half height, in air of 1 atm at 296 K
};

// Mass and temperature dependence of a gas's lines, and how their far wings fall.
struct LineShape {
  double molar_mass_g;
  double width_exponent;  // width ~ (296 K / T)^exponent
  bool sub_lorentzian;    // wings beyond 3 cm-1: carbon dioxide's    [perrin1989]
  double far_cm1 = 200;   // wings end there; of lines below 1e-23 cm per molecule at 25
};

// hc/k, and molecules per cm3 at 1 atm and 1 K.            [codata2018]
inline constexpr double kC2CmK = 1.4387768775;
inline constexpr double kMoleculesCm3KAtm = 7.3389e21;

}  // namespace irsig
