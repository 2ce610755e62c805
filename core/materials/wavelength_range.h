#pragma once

#include "core/materials/material_spec.h"

namespace irsig {

// Where all tables of a material are known. `everywhere`: it has no table.
struct WavelengthRange {
  double min_um, max_um;
  bool everywhere;
};
[[nodiscard]] WavelengthRange wavelength_range(const MaterialSpec& spec);

}  // namespace irsig
