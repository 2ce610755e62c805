#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/materials/optical/material_library.h"

namespace irsig {

// A material that the command line names, ready to be looked at.
struct ChosenMaterial {
  MaterialSpec spec;
  LibraryEntry entry;     // of the library: where it comes from; else empty but for the name
  double min_um, max_um;  // where to look: the sweep's bands, or where the material is known
  std::vector<double>
      lambda_um;  // a few wavelengths there: the middles of the bands, or usual ones
};

// Finds a material by name: "iron" (the library), "hull" (built in) or "sweeps/frigate.toml:deck".
[[nodiscard]] absl::StatusOr<ChosenMaterial> choose_material(const std::string& name);

// Returns every material of a sweep file.
[[nodiscard]] absl::StatusOr<std::vector<ChosenMaterial>> materials_of_sweep(
    const std::string& path);

}  // namespace irsig
