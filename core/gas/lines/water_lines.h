#pragma once

#include "core/gas/lines/spectral_line.h"

namespace irsig {

// Lines of water vapour from 30 to 7200 cm-1, computed (water_levels.h): no line list is copied.
//
//   kinds      H2 16O, which stands for the other oxygens as well, and HDO (3.107e-4)
//   levels     J to 36 below 16000 cm-1, lines from those below 12500 cm-1 (HDO: 30, 11000, 7000)
//   strengths  as the dipole surface has them, nothing is fitted
//   widths     in air, 0.1 cm-1/atm at 296 K falling with J to 0.02; (296 K / T)^n, n from 0.75 to
//              0.35 as J rises
//
//   temperature_k  100 to 3000
//   weakest        lines below it at that temperature are left out; below 1e-28 none are
// The first call computes all transitions, two minutes. One thread at a time.
[[nodiscard]] std::vector<SpectralLine> water_lines(double temperature_k, double weakest);

// Returns the partition sum of H2 16O with nuclear weights 1 and 3, from the levels: 174.58 at 296
// K. [1]
[[nodiscard]] double water_partition_sum(double temperature_k);

inline constexpr LineShape kWaterShape = {18.015, 0, false, 25};

}  // namespace irsig
