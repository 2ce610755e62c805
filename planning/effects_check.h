#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/study/effects_check.h"
#include "planning/load_sweep.h"

namespace irsig {

// First line of a comparison between two runs of this program: the errors that both runs share
// cannot show in it.
inline constexpr const char* kNotSeenByEffects =
    "not seen here, because both runs share it: facets and ray tracer, formulas and tables of "
    "materials, sun and air, quadrature over wavelength, sky and sea between their directions, one "
    "range for the target's depth, bright paths that neither run met, the horizon; `irsig selftest "
    "--search` judges these by other means";

struct EffectsCheckAsked {
  std::uint64_t views = 5;         // number of views, spread over the sweep, with all their rows
  std::vector<std::uint64_t> row;  // instead: these rows, each by itself
  std::uint32_t timed = 1;
  double reference_paths = 0;  // as in EffectsCheckOptions
};

// Computes views of a sweep with the effects that its error needs, and with all effects. `seen`
// receives each view when it is done. INVALID_ARGUMENT: the sweep requests no relative error, or
// has no such row.
[[nodiscard]] absl::StatusOr<std::vector<CheckedView>> check_sweep_effects(
    const LoadedSweep& loaded, const EffectsCheckAsked& asked, const CpuClock& cpu_s,
    const std::function<void(const CheckedView&)>& seen);

}  // namespace irsig
