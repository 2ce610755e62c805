#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"

namespace irsig {

// DHR and directional emissivity of a material at one wavelength and angle of incidence.
struct AngularValue {
  double lambda_um, theta_i_deg, dhr, emissivity;
};

struct AngularTable {
  std::vector<AngularValue> value;  // angle within wavelength
  bool creates_energy = false;      // dhr + emissivity > 1 somewhere: also between these angles
};

// Tabulates a material as the tracer uses it: by Material::prepare's tables, whose accuracy is
// stated there.
//   lambda_um    any order, not empty; within the material's range     [um]
//   theta_i_deg  from the normal, [0, 90]                              [degree]
[[nodiscard]] absl::StatusOr<AngularTable> angular_table(const MaterialSpec& spec,
                                                         const std::vector<double>& lambda_um,
                                                         const std::vector<double>& theta_i_deg);

}  // namespace irsig
