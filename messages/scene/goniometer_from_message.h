#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "core/goniometer/goniometer.h"
#include "core/scene/generate/generate_particles.h"
#include "schema/goniometer.pb.h"

namespace irsig {

// Returns the grains of a resolved goniometer file at one coverage. nullopt: a bed of stated
// layers. INVALID_ARGUMENT: an unknown name.
[[nodiscard]] absl::StatusOr<ParticleBed> bed_of(const schema::Goniometer& spec,
                                                 std::optional<double> coverage);

[[nodiscard]] absl::StatusOr<GoniometerSpec> instrument_of(const schema::Goniometer& spec,
                                                           std::uint32_t threads);

}  // namespace irsig
