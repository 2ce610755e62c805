#include "core/atmosphere/gas_terms.h"

#include "core/atmosphere/gas_table.h"

namespace irsig {

namespace {

// Entries of the table by gas and band; -1: the gas has no lines there.
const std::vector<std::ptrdiff_t>& entries() {
  static const std::vector<std::ptrdiff_t> index = [] {
    const GasTable& table = gas_table();
    std::vector<std::ptrdiff_t> out(kGasCount * kAirBandCount, -1);
    for (std::size_t g = 0; g < kGasCount; ++g)
      for (std::size_t e = GasTable::kLanes * table.gas_begin[g];
           e < GasTable::kLanes * table.gas_begin[g + 1]; ++e)
        if (const std::size_t band = table.entry[e].band; band < kAirBandCount)
          out[g * kAirBandCount + band] = static_cast<std::ptrdiff_t>(e);
    return out;
  }();
  return index;
}

}  // namespace

GasTerms gas_terms(const AbsorberAmounts& amounts, Gas gas, std::size_t band) {
  GasTerms out;
  const std::ptrdiff_t found = entries()[static_cast<std::size_t>(gas) * kAirBandCount + band];
  if (found < 0) return out;
  const GasTable& table = gas_table();
  const auto e = static_cast<std::size_t>(found);
  const GasTable::Entry& entry = table.entry[e];
  for (std::size_t i = entry.first_term; i < entry.first_term + entry.terms; ++i) {
    out.depth.push_back(table.k_scaled_m2_kg[i] * amounts.gas_scaled_kg_m2[e] +
                        table.k_plain_m2_kg[i] * amounts.gas_plain_kg_m2[e]);
    out.weight.push_back(table.weight[i]);
  }
  return out;
}

}  // namespace irsig
