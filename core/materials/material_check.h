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
// state how reciprocal and how complete the user's table was; they always pass. Seeds are fixed:
// the same rows for the same material.
//
// A material creates energy in one of two ways, and the rows say which. "energy" looks at the BRDF
// alone: DHR <= 1 at every angle and wavelength. "emissivity + DHR = 1" means it literally: what
// fails is an emissivity that is not 1 - DHR, be it stated (hull_paper: 0.8 beside a DHR of 0.835)
// or clamped at 0 because DHR > 1 - then "energy" fails as well.
//
// Errors: what Material::prepare refuses; no wavelength.
[[nodiscard]] absl::StatusOr<std::vector<MaterialCheckRow>> check_material(
    const MaterialSpec& spec, const std::vector<double>& lambda_um);

}  // namespace irsig
