#pragma once

#include <span>
#include <vector>

#include "core/gas/lines/spectral_line.h"

namespace irsig {

// Wavenumbers first + (i + 0.5) step.
struct WavenumberGrid {
  double first_cm1, step_cm1;
  std::size_t count;
  [[nodiscard]] double at(std::size_t i) const {
    return first_cm1 + (static_cast<double>(i) + 0.5) * step_cm1;
  }
};

// Computes the absorption of a gas line by line. [cm2 / molecule]
// Lines are Voigt's, with wings to LineShape::far_cm1 from the centre; those of carbon dioxide are
// multiplied by the factor of CO2 in nitrogen beyond 4 cm-1 [perrin1989]. Lines weaker than 1e-23
// cm per molecule end at 25 cm-1.
[[nodiscard]] std::vector<double> absorption_cm2(std::span<const SpectralLine> lines,
                                                 const LineShape& shape, double temperature_k,
                                                 double pressure_atm, const WavenumberGrid& grid);

// Returns the fraction of a Lorentz wing that is left at a distance from the line's centre.
// [perrin1989]
[[nodiscard]] double co2_wing(double distance_cm1, double temperature_k);

}  // namespace irsig
