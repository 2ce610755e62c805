#pragma once

namespace irsig {

// Convection at a face of T_s in a fluid of T_a takes h (T_s - T_a), with
//
//   n = natural |T_s - T_a|^(1/3),  h = sqrt(n^2 + forced^2 + 2 mixing n forced)  [W m^-2 K^-1]
//
// natural [W m^-2 K^(-4/3)] of a face warmer or colder than the fluid; mixing 0: root of the sum of
// squares, 1: sum. The forced part, which wind and current change, is part of the forcing.
struct Convection {
  double natural_warm, natural_cold;  // >= 0
  double mixing;                      // [0, 1]
};

// A stated h, which is then the forced part.
inline constexpr Convection kForcedOnly{0, 0, 0};

// Smooth vertical plates in wind, measured at the Mobile Window Thermal Test facility
// [yazdanian1994]: n with 0.84 and forced = a V^b. Range: 0-12 m/s, up to a few metres above
// ground.
inline constexpr Convection kMowitt{0.84, 0.84, 0};
enum class WindSide { kWindward, kLeeward };
// Returns the forced part with a, b = 3.26, 0.89 windward and 3.55, 0.617 leeward; wind_m_s >= 0.
[[nodiscard]] double mowitt_forced_w_m2_k(double wind_m_s, WindSide side);

// Returns the natural convection of large faces in air near 300 K, as in TARP [walton1983]:
//   9.482 / (7.238 - |c|)  unstable: a face that looks up is the warmer, or down and the colder
//   1.810 / (1.382 + |c|)  stable; both are 1.31 for a vertical face
//   cos_tilt c  of the face's outward normal to the vertical: 1 looks up, -1 down
// mixing 1: forced parts add. Turbulent: |T_s - T_a| times the cube of the size above about 1 K
// m^3.
[[nodiscard]] Convection tarp_natural(double cos_tilt);
// Returns 2.537 R sqrt(perimeter wind / area), half of it on the leeward side [sparrow1979,
// walton1983]:
// rectangles in wind at up to some 1e5 of Reynolds number.
//   roughness R: 1 glass, 1.11 smooth paint, 1.67 rough concrete, 2.17 stucco
[[nodiscard]] double tarp_forced_w_m2_k(double wind_m_s, double perimeter_m, double area_m2,
                                        double roughness, WindSide side);

struct Fluid {
  double conductivity_w_m_k, kinematic_viscosity_m2_s, prandtl;
};
// Properties of sea water of 35 g/kg, 0 to 40 deg C: viscosity by [sharqawy2010, eqs. 22, 23];
// conductivity 0.570 W/(m K) at 0 deg C and 0.0014 more a kelvin (read off its fig. 7, 1 %),
// volumetric heat capacity 4.10 MJ/(m3 K) (0.5 %).
[[nodiscard]] Fluid sea_water(double temperature_k);

// Returns the mean h along a plate in a flow parallel to it [incropera2007, eqs. 7.30, 7.38]:
//   Re < 5e5: Nu = 0.664 Re^(1/2) Pr^(1/3), above: Nu = (0.037 Re^(4/5) - 871) Pr^(1/3)
// 0 at speed 0. Range: 0.6 < Pr < 60, Re < 1e8; a hull's Re goes to 1e9. 15 to
// 25 % of h; a hull's curvature, fouling and wake are not in it.
[[nodiscard]] double plate_in_flow_w_m2_k(const Fluid& fluid, double speed_m_s, double length_m);

}  // namespace irsig
