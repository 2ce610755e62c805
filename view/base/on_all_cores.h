#pragma once

#include <cstddef>
#include <functional>

#include "absl/status/status.h"

namespace irsig {

// Calls work(i) for i < count on as many threads as there are cores, each i once; the first failure
// in the order of i.
[[nodiscard]] absl::Status on_all_cores(std::size_t count,
                                        const std::function<absl::Status(std::size_t)>& work);

}  // namespace irsig
