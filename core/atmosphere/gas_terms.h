#pragma once

#include <cstddef>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"

namespace irsig {

// The exponentials of which a gas's factor of a band's transmittance is the mean, for what has
// lines of its own in the same places (core/gas): in the table's order, weights add up to 1. None
// where the gas has no lines.
struct GasTerms {
  std::vector<double> depth, weight;
};
[[nodiscard]] GasTerms gas_terms(const AbsorberAmounts& amounts, Gas gas, std::size_t band);

}  // namespace irsig
