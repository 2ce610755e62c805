#pragma once

#include <vector>

namespace irsig {

// Vibration and rotation of carbon dioxide near its equilibrium: levels with the same 2 v1 + v2, l
// and v3 mixed by the Fermi resonance.

// Constants that differ between isotopologues.
struct Co2Isotopologue {
  double abundance;
  double omega1_shift_cm1, omega2_shift_cm1;
  double fundamental_cm1;  // of the asymmetric stretch
  double rotation;         // B over that of 12C16O2
  bool symmetric;          // every other level is missing
};
inline constexpr Co2Isotopologue kCo2Isotopologues[] = {
    {0.984204, 0, 0, 2349.143, 1, true},                // 16O12C16O
    {0.011057, 0, -18.9, 2283.488, 1, true},            // 16O13C16O
    {0.003947, -38.4, -5.0, 2332.112, 0.94353, false},  // 16O12C18O
    {0.000734, -20.0, -2.65, 2340.014, 0.9703, false},  // 16O12C17O
};

// The levels of one polyad at one J; those of l > 0 are pairs, of which this is one.
struct Polyad {
  std::vector<double> energy_cm1;              // above the molecule's lowest level
  std::vector<std::vector<double>> amplitude;  // [level][v1]: of the state v1, v2 = quanta - 2 v1
};

// Computes the levels of one polyad.
//   quanta  2 v1 + v2 >= l;  l >= 0;  v3 >= 0;  j >= l
//   upper   of the pair (l = 1 alone is split): the f level, whose B is larger
[[nodiscard]] Polyad co2_polyad(const Co2Isotopologue& of, int quanta, int l, int v3, int j,
                                bool upper);

}  // namespace irsig
