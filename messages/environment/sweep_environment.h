#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/environment/environment.h"
#include "messages/environment/weather_from_message.h"
#include "schema/job.pb.h"

namespace irsig {

// Makes air, sky and sea from a resolved sweep: for the worker, and for code that evaluates a line
// of sight of a stored sweep again (another range, a printed sky). Pure: a resolved sweep names no
// file. Only for sweeps for which has_atmosphere() is true (weather_from_message.h).

// [condition]: the number of its weather, of as many as differ.
struct SweepWeathers {
  std::vector<std::uint32_t> of_condition;
  std::uint32_t count = 0;
};
[[nodiscard]] SweepWeathers weathers_of(const schema::ResolvedSweep& sweep);

// Makes all conditions of the sweep, in its order; conditions with the same weather share it.
//   node_um  the wavelengths [um]; OUT_OF_RANGE outside the atmosphere's table
[[nodiscard]] absl::StatusOr<std::unique_ptr<const Environment>> environment_of(
    const schema::ResolvedSweep& sweep, std::span<const double> node_um);

// Returns the wavelengths at which the spectra of air and hot gas jump inside the sweep's bands and
// a bin beyond them (SceneSpec); empty without the embedded atmosphere and without hot gas. [um]
[[nodiscard]] std::vector<double> spectral_breaks_um(const schema::ResolvedSweep& sweep);

}  // namespace irsig
