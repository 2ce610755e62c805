#include "runner/heat_outputs.h"

#include <utility>

#include "core/base/status_macros.h"
#include "runner/heat_field.h"

namespace irsig {

absl::StatusOr<HeatOutputs> heat_outputs(const schema::ResolvedSweep& sweep, const Assets& assets) {
  HeatOutputs out;
  for (int run = 0; run < sweep.heat_size(); ++run) {
    ASSIGN_OR_RETURN(auto computed, compute_heat(sweep, assets, static_cast<std::size_t>(run)));
    out.push_back(std::move(*computed.mutable_field()));
  }
  return out;
}

}  // namespace irsig
