#pragma once

#include "core/gas/lines/spectral_line.h"

namespace irsig {

// 4.3 um with the weak bands near 4.8 um: 1900-2480 cm-1; 10 um: 800-1130; 15 um: 460-920 cm-1.
enum class Co2Region { k4um, k10um, k15um };

// Lines of carbon dioxide, computed from molecular constants: no line list is copied.
//
//   levels      polyads of 2 v1 + v2 <= 20 and v3 <= 7 below 16000 cm-1, four isotopologues
//   transitions v3 to v3 + 1; v1, v2, l to v1 + 1, v2 + 1, l +- 1 and v2, l to v2 + 3, l +- 1 (4.8
//               um); v2, l to v2 + 1, l +- 1 (15 um);
//               v1 to v1 - 1 or v2 to v2 - 2 with v3 to v3 + 1 (10 um); harmonic moments between
//               the mixed states
//   strengths   one number for each kind: 9.13e-17 cm per molecule of CO2 at 296 K
//               for (00011)-(00001) of 16O12C16O [rothman1981]; the others fitted
//
//   temperature_k  100 to 3000
//   weakest        lines below it at that temperature are left out
// One thread at a time.
[[nodiscard]] std::vector<SpectralLine> co2_lines(Co2Region region, double temperature_k,
                                                  double weakest);

inline constexpr LineShape kCo2Shape = {44.01, 0.73, true};

}  // namespace irsig
