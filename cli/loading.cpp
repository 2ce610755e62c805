#include "cli/loading.h"

#include "view/base/progress.h"

namespace irsig {

absl::StatusOr<LoadedSweep> load_shown(const std::string& path, const AccuracyAsked& asked) {
  const WaitProgress wait("reading the sweep and building its scene");
  return load_sweep(path, asked);
}

absl::StatusOr<std::string> spend_shown(LoadedSweep& loaded, std::uint32_t workers) {
  const WaitProgress wait("pilot of the time budget");
  return spend_time_budget(loaded, workers);
}

}  // namespace irsig
