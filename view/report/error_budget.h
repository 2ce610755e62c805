#pragma once

#include <string>
#include <vector>

#include "view/query/query.h"

namespace irsig {

// One reason why a value may be off.
struct ErrorPart {
  std::string name, what;
  bool bound;         // else a standard error
  double error_w_sr;  // a bound, or one sigma
  double share;       // of the square of the numerical error; all shares together are 1
};

// Returns the parts of the numerical error of a row's intensity, apparent or contrast intensity:
// its standard errors, then its bounds, those of 0 included. For a row that was moved to another
// range, bounds are known only together. Empty: the quantity has no bounds (background radiance),
// or the row is interpolated or was stored without the quantity.
[[nodiscard]] std::vector<ErrorPart> error_budget(const QueryRow& row,
                                                  const QuantityColumns& quantity);

}  // namespace irsig
