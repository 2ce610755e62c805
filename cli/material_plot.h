#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "cli/choose_material.h"

namespace irsig {

// Plots DHR and directional emissivity against angle (at the given wavelengths) and against
// wavelength (at a few angles), as SVG.
[[nodiscard]] absl::StatusOr<std::string> plot_material(const ChosenMaterial& material);

}  // namespace irsig
