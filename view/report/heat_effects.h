#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Effects on computed temperatures that a sweep has left out, in the rows of the sweep: made once
// from the outputs of its heat jobs.
class HeatEffects {
 public:
  // Reads the effects of a sweep. INVALID_ARGUMENT: the output of a heat job cannot be read.
  [[nodiscard]] static absl::StatusOr<HeatEffects> make(const StoredSweep& sweep);

  // Lines of a row's ledger; none where no temperature of its condition was computed, or is known.
  // Off: a part of the row's temperature bounds. Each temperature's error has the effect's bound b
  // in it, b <= r error, and Planck's function is convex in temperature, so that b changes a row by
  // r times its temperature bound at most; r: the largest of the facets.
  [[nodiscard]] std::vector<StoredEffect> of(const StoredSignature& row) const;
  // The largest bound of the row's facets, of those effects whose bound is known.              [K]
  struct Kelvin {
    std::string effect;
    bool off;
    double largest_k;
  };
  [[nodiscard]] std::vector<Kelvin> kelvin_of(const StoredSignature& row) const;

 private:
  struct OfCondition {
    std::string season, time_utc;
    std::vector<Kelvin> effect;    // none: nothing is left out
    std::vector<double> of_error;  // [effect] r
  };
  [[nodiscard]] const OfCondition* find(const StoredSignature& row) const;

  std::vector<OfCondition> condition_;
};

}  // namespace irsig
