#pragma once

#include <span>
#include <string_view>

#include "core/thermal/layers.h"

namespace irsig {

// Solids that layers are made of, by name. Design values: those of a given sample differ by a few
// percent (metals) to a factor of two (soils, masonry, timber by moisture).
struct Solid {
  std::string_view name;
  double conductivity_w_m_k, density_kg_m3, specific_heat_j_kg_k;
  std::string_view description, source;  // a key of docs/references.bib, and where in it
};
[[nodiscard]] std::span<const Solid> solids();
// nullptr: there is none of this name.
[[nodiscard]] const Solid* solid_named(std::string_view name);

}  // namespace irsig
