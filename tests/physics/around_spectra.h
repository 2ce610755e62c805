#pragma once

#include <vector>

#include "core/environment/environment.h"

namespace irsig {

// Spectra of all direction nodes, written down.
inline std::vector<std::vector<double>> radiance_of(const IncidentRadiance& around) {
  std::vector<std::vector<double>> out;
  for (std::uint32_t n = 0; n < around.count(); ++n) out.push_back(around.radiance(n));
  return out;
}
inline std::vector<std::vector<double>> apparent_of(const IncidentRadiance& around) {
  std::vector<std::vector<double>> out;
  for (std::uint32_t n = 0; n < around.count(); ++n) out.push_back(around.apparent(n));
  return out;
}
inline std::vector<std::vector<double>> interpolation_of(const IncidentRadiance& around) {
  std::vector<std::vector<double>> out;
  for (std::uint32_t n = 0; n < around.count(); ++n) out.push_back(around.interpolation(n));
  return out;
}

}  // namespace irsig
