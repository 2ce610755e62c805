#pragma once

#include "core/gas/lines/spectral_line.h"

namespace irsig {

// Lines of carbon dioxide from 1900 to 2480 cm-1 (4.3 um, and the weak bands near 4.8 um), computed
// from molecular constants: no line list is copied.
//
//   levels      polyads of 2 v1 + v2 <= 15 and v3 <= 5 below 12000 cm-1, four isotopologues
//   transitions v3 to v3 + 1, a harmonic moment; v1, v2, l to v1 + 1, v2 + 1, l +- 1
//   strengths   one number for each of the two kinds: 9.13e-17 cm per molecule of CO2 at 296 K for
//               (00011)-(00001) of 16O12C16O [rothman1981]; of the second kind fitted
//
//   temperature_k  100 to 2500
//   weakest        lines below it at that temperature are left out
[[nodiscard]] std::vector<SpectralLine> co2_lines(double temperature_k, double weakest);

inline constexpr LineShape kCo2Shape = {44.01, 0.73, true};

}  // namespace irsig
