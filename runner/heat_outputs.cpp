#include "runner/heat_outputs.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/base/status_macros.h"
#include "runner/heat_field.h"
#include "runner/sweep_land.h"
#include "schema/heat_run.h"

namespace irsig {

absl::StatusOr<HeatOutputs> heat_outputs(const schema::ResolvedSweep& sweep, const Assets& assets) {
  HeatOutputs out;
  std::shared_ptr<const LandScene> land;
  if (std::any_of(sweep.heat().begin(), sweep.heat().end(), computes_land)) {
    ASSIGN_OR_RETURN(land, land_from_sweep(sweep, assets));
  }
  for (int run = 0; run < sweep.heat_size(); ++run) {
    ASSIGN_OR_RETURN(auto computed,
                     compute_heat(sweep, assets, static_cast<std::size_t>(run), land.get()));
    out.push_back(std::move(*computed.mutable_field()));
  }
  return out;
}

}  // namespace irsig
