#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Reduces the whole resolved sweep to its shard "K/N": every N-th viewpoint from the K-th on, with
// all conditions and bands. The set of jobs changes; keys and results do not, because those of a
// view do not depend on other views. "1/1" is the whole sweep. INVALID_ARGUMENT: the text is not
// K/N with 1 <= K <= N <= the number of viewpoints; or the sweep has a time budget, whose samples
// depend on a machine and a number of views.
[[nodiscard]] absl::Status take_shard(std::string_view shard, schema::ResolvedSweep& sweep);

}  // namespace irsig
