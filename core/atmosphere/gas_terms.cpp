#include "core/atmosphere/gas_terms.h"

#include "core/atmosphere/gas_table.h"

namespace irsig {

GasTerms gas_terms(const AbsorberAmounts& amounts, Gas gas, std::size_t band) {
  const GasTable& table = gas_table();
  const auto g = static_cast<std::size_t>(gas);
  GasTerms out;
  for (std::size_t e = GasTable::kLanes * table.gas_begin[g];
       e < GasTable::kLanes * table.gas_begin[g + 1]; ++e) {
    const GasTable::Entry& entry = table.entry[e];
    if (entry.band != band) continue;
    for (std::size_t i = entry.first_term; i < entry.first_term + entry.terms; ++i) {
      out.depth.push_back(table.k_scaled_m2_kg[i] * amounts.gas_scaled_kg_m2[e] +
                          table.k_plain_m2_kg[i] * amounts.gas_plain_kg_m2[e]);
      out.weight.push_back(table.weight[i]);
    }
    return out;
  }
  return out;
}

}  // namespace irsig
