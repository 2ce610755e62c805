#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/trace/target.h"
#include "core/spectral/band.h"
#include "schema/sweep.pb.h"

namespace irsig {

// Converts the parts of a sweep [part], with their materials by index.
[[nodiscard]] absl::StatusOr<std::vector<PartSpec>> parts_from_sweep(const schema::Sweep& sweep);

// Returns the materials of [land] by number, in their order. INVALID_ARGUMENT
// "land.material[i].material": a name that no material has.
[[nodiscard]] absl::StatusOr<std::vector<std::uint32_t>> land_materials_from_sweep(
    const schema::Sweep& sweep);

[[nodiscard]] std::vector<Band> bands_from_sweep(const schema::Sweep& sweep);

}  // namespace irsig
