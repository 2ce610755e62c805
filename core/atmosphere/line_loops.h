#pragma once

#include <cstddef>

#include "core/atmosphere/gas_table.h"

namespace irsig {

// The loops over absorption lines, as those of band_loops.h. Private to core/atmosphere.

// Multiplies t[band] by the lines' transmittance. Amounts: per entry of the gas table.
//   t  kAirBandCount + 1 bands
void multiply_lines(const LineTerms& lines, const double* scaled, const double* plain, double* t);

// Adds a stretch's amounts to the entries of a group.
//   warmth    T / T0 - 1
//   kg_m2     of the gas
void add_to_lines(const GasTable& table, std::size_t group, double ln_pressure, double warmth,
                  double kg_m2, double* scaled, double* plain);

}  // namespace irsig
