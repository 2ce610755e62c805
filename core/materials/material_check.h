#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"

namespace irsig {

// One line of a material's self-examination.
struct MaterialCheckRow {
  std::string check;  // what is examined, e.g. "reciprocity"
  double worst = 0;   // the largest deviation found, in the unit of `bound`
  double bound = 0;
  bool passed = false;
  std::string where;  // the angles and the wavelength of the worst case
};

// Examines a material at the given wavelengths: reciprocity; DHR <= 1; emissivity + DHR = 1; the
// sampling density's integral; chi-square of sampled directions against that density (`worst` is 1
// - p there, so that `passed` is worst <= bound as everywhere); the DHR that sampling finds against
// the table; finiteness at grazing. Where a row compares with a sampled mean, `worst` is in units
// of what 5 standard errors and the table's error allow. A tabulated BRDF has two more rows that
// state how reciprocal and how complete the user's table was; they always pass. A material that
// creates energy fails "energy"; it fails "emissivity + DHR = 1" only if its emissivity is forced
// (where DHR > 1, emissivity 0 is expected). Seeds are fixed: the same rows for the same material.
//
// Errors: what Material::prepare refuses; no wavelength.
[[nodiscard]] absl::StatusOr<std::vector<MaterialCheckRow>> check_material(
    const MaterialSpec& spec, const std::vector<double>& lambda_um);

}  // namespace irsig
