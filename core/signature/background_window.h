#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/spectral/spectral_axis.h"

namespace irsig {

// Width of the window around a target over which its background is measured, in diameters of the
// target, and its pixels along each side.
inline constexpr double kClutterDiameters = 8;
inline constexpr std::uint32_t kClutterPixels = 64;

// Means of a spectrum on the sweep's nodes over the bins of a band.
[[nodiscard]] std::vector<double> on_bins(std::span<const double> spectrum, const BandOnAxis& band);

}  // namespace irsig
