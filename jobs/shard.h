#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Makes the whole resolved sweep its shard "K/N": every N-th viewpoint, from the K-th on, with all
// conditions and bands. Which jobs there are changes; keys and results do not, as those of a view
// do not depend on other views. "1/1" is the whole. INVALID_ARGUMENT: no K/N with 1 <= K <= N <=
// the number of viewpoints; or a time budget, whose samples are those of a machine and a number of
// views.
[[nodiscard]] absl::Status take_shard(std::string_view shard, schema::ResolvedSweep& sweep);

}  // namespace irsig
