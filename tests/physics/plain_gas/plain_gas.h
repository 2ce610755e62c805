#pragma once

#include <span>

#include "absl/status/statusor.h"
#include "core/gas/gas_spectrum.h"

// core/gas as its formulas are written, number by number, with the standard library's functions:
// what the loops of core/gas are compared with, in results (gas_path_test.cpp) and in time
// (tests/benchmark/gas_bench.cpp).
namespace irsig::plain {

[[nodiscard]] absl::StatusOr<GasSpectrum> gas_spectrum(std::span<const GasLayer> path,
                                                       GasBands bands = {});
[[nodiscard]] absl::StatusOr<GasThroughAir> gas_through_air(std::span<const GasLayer> path,
                                                            const AbsorberAmounts& air,
                                                            GasBands bands = kAirGasBands);

}  // namespace irsig::plain
