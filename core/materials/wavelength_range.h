#pragma once

#include "core/materials/material_spec.h"

namespace irsig {

// Range of wavelengths that all tables of a material cover. `everywhere`: the material has no
// table.
struct WavelengthRange {
  double min_um, max_um;
  bool everywhere;
};
[[nodiscard]] WavelengthRange wavelength_range(const MaterialSpec& spec);

}  // namespace irsig
