#include "worker/shared_runners.h"

#include "core/base/status_macros.h"

namespace irsig {

absl::StatusOr<std::shared_ptr<const JobRunner>> SharedRunners::get(const Key& key,
                                                                    const Make& make) {
  const std::lock_guard lock(mutex_);
  std::erase_if(known_, [](const auto& known) { return known.second.expired(); });
  for (const auto& [of, runner] : known_) {
    if (of.sweep_sha256 != key.sweep_sha256) continue;
    if (!key.outputs.empty() && of.outputs != key.outputs) continue;
    if (std::shared_ptr<const JobRunner> there = runner.lock()) return there;
  }
  ASSIGN_OR_RETURN(std::shared_ptr<const JobRunner> runner, make(assets_));
  known_.emplace_back(key, runner);
  return runner;
}

void SharedRunners::forget(const std::shared_ptr<const JobRunner>& runner) {
  const std::lock_guard lock(mutex_);
  std::erase_if(known_, [&](const auto& known) { return known.second.lock() == runner; });
}

}  // namespace irsig
