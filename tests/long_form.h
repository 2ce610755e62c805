#pragma once

#include <cstdlib>

namespace irsig {

// True in the long form of a test (ctest label `long`: ops/test.sh -C Long -L long), which draws
// more samples or cases than the default run. The default form detects the same faults; the long
// form bounds smaller errors.
inline bool long_form() { return std::getenv("IRSIG_LONG") != nullptr; }

}  // namespace irsig
