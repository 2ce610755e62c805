#pragma once

#include <cstdint>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"

namespace irsig {

// Replaces means over the hat functions of nodes (rings of the given sines x azimuths) by the node
// values whose linear interpolation best fits these means. The fit keeps energy and hardly blurs
// the light of lobes wider than a hat. Private to core/environment.
void fit_to_hats(std::vector<AirSpectrum>& node, const std::vector<double>& sine,
                 std::uint32_t azimuths);

// Replaces fitted values that light cannot have by less of the fit: in each band so much of the
// means over hats that no node falls below a quarter of its own. Sums over directions stay, as both
// have them. Narrow peaks need it, whose fit is negative beside them.
//   mean  over the hats, >= 0
void keep_positive(std::vector<AirSpectrum>& node, const std::vector<AirSpectrum>& mean);

// Returns the largest value that a node can have if the fitted function lies between 0 and 1.
[[nodiscard]] double fit_overshoot(const std::vector<double>& sine, std::uint32_t azimuths);

}  // namespace irsig
