#pragma once

#include <cstdint>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"

namespace irsig {

// From means over the hat functions of nodes (rings of those sines x azimuths) to the values at the
// nodes whose linear interpolation has those means: the best fit, which keeps energy and hardly
// blurs what lobes wider than a hat see of it. Private to core/environment.
void fit_to_hats(std::vector<AirSpectrum>& node, const std::vector<double>& sine,
                 std::uint32_t azimuths);

// The most that a node's value can be if what is fitted is between 0 and 1.
[[nodiscard]] double fit_overshoot(const std::vector<double>& sine, std::uint32_t azimuths);

}  // namespace irsig
