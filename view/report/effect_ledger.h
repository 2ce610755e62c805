#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schema/store/tables/rows.h"

namespace irsig {

// Returns a reason of the ledger (StoredEffect::reason) in words.
[[nodiscard]] std::string_view reason_in_words(std::string_view reason);

// Returns the ledger of one row as a table with a line for each effect; empty for an empty ledger.
[[nodiscard]] std::string ledger_table(const StoredSignature& row,
                                       const std::vector<StoredEffect>& ledger);

struct LedgerRow {
  StoredSignature signature;
  StoredLedger ledger;
};

// One effect over many rows.
struct EffectSummary {
  std::string effect;
  std::uint64_t on = 0, off = 0, absent = 0;
  // Largest bound relative to the intensity, of the source or at the aperture, over the rows where
  // the effect is off. kNotComputed: the effect is off in no row, or a bound is not known.
  double largest_bound = kNotComputed;
  std::map<std::string, std::uint64_t> reason;  // of the rows where it is not absent
  // Sums over all views; kNotComputed: no ledger states them.
  double saved_s = kNotComputed, spent_s = kNotComputed;
};

// Returns the effects in the order of the ledger. Rows without a ledger are left out.
[[nodiscard]] std::vector<EffectSummary> summarize_effects(std::span<const LedgerRow> rows);

[[nodiscard]] std::string summary_table(const std::vector<EffectSummary>& summary);

}  // namespace irsig
