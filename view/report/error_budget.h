#pragma once

#include <string>
#include <vector>

#include "view/query/query.h"

namespace irsig {

// One part of the error of a value.
struct ErrorPart {
  std::string name, what;
  bool bound;         // else a standard error
  double error_w_sr;  // a bound, or one sigma
  double share;       // of the square of the numerical error; all shares together are 1
};

// Returns the parts of the numerical error of a row's intensity, apparent or contrast intensity:
// its standard errors, then its bounds, including zeros. For a row moved to another range, only the
// sum of the bounds is known. Empty: the quantity has no bounds (background radiance), or the row
// is interpolated or was stored without the quantity.
[[nodiscard]] std::vector<ErrorPart> error_budget(const QueryRow& row,
                                                  const QuantityColumns& quantity);

}  // namespace irsig
