#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/study/effects_check.h"
#include "planning/load_sweep.h"

namespace irsig {

struct EffectsCheckAsked {
  std::uint64_t views = 5;         // so many, spread over the sweep, with all their rows
  std::vector<std::uint64_t> row;  // instead: these rows, each by itself
  std::uint32_t timed = 1;
  double reference_paths = 0;  // as EffectsCheckOptions has it
};

// Views of a sweep with the effects that its error calls for, and with all; `seen` is told of each
// when it is done. INVALID_ARGUMENT: the sweep asks for no relative error, or has no such row.
[[nodiscard]] absl::StatusOr<std::vector<CheckedView>> check_sweep_effects(
    const LoadedSweep& loaded, const EffectsCheckAsked& asked, const CpuClock& cpu_s,
    const std::function<void(const CheckedView&)>& seen);

}  // namespace irsig
