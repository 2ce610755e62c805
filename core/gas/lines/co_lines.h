#pragma once

#include "core/gas/lines/spectral_line.h"

namespace irsig {

// Lines of carbon monoxide's fundamental and its hot bands, v to v + 1 for v < 10, from molecular
// constants of three isotopologues [guelachvili1983]; strength 9.9e-18 cm per molecule of CO at 296
// K, growing as v + 1; widths of [hunt1968]. The same as the cold air's (core/atmosphere/data).
[[nodiscard]] std::vector<SpectralLine> co_lines(double temperature_k, double weakest);

inline constexpr LineShape kCoShape = {28.01, 0.69, false};

}  // namespace irsig
