#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Effects on computed temperatures that a sweep has left out, for the rows of the sweep; made once
// from the outputs of its heat jobs.
class HeatEffects {
 public:
  // Reads the effects of a sweep. INVALID_ARGUMENT: the output of a heat job cannot be read.
  [[nodiscard]] static absl::StatusOr<HeatEffects> make(const StoredSweep& sweep);

  // Returns lines of a row's ledger; none if no temperature of its condition was computed, or none
  // is known. The bound of an effect that is off is a part of the row's temperature bounds. Each
  // temperature's error includes the effect's bound b, with b <= r error. Planck's function is
  // convex in temperature, so that b changes a row by at most r times its temperature bound; r is
  // the largest of the facets.
  [[nodiscard]] std::vector<StoredEffect> of(const StoredSignature& row) const;
  // Largest bound [K] over the row's facets, for effects whose bound is known.
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
