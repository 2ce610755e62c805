#include "core/thermal/layers.h"

#include <cstddef>

#include "absl/strings/str_cat.h"

namespace irsig {

absl::Status check_layers(std::span<const Layer> layers) {
  if (layers.empty()) return absl::InvalidArgumentError("a wall needs at least one layer");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Layer& layer = layers[i];
    struct Number {
      const char* name;
      double value, low, high;
      bool may_be_zero;
    };
    for (const Number& n :
         {Number{"thickness_m", layer.thickness_m, 1e-9, 1e6, false},
          Number{"conductivity_w_m_k", layer.conductivity_w_m_k, 1e-9, 1e12, true},
          Number{"density_kg_m3", layer.density_kg_m3, 0, 1e9, true},
          Number{"specific_heat_j_kg_k", layer.specific_heat_j_kg_k, 0, 1e9, true}}) {
      if (n.value >= n.low && n.value <= n.high) continue;
      if (n.may_be_zero && n.value == 0) continue;
      return absl::InvalidArgumentError(
          absl::StrCat("layer ", i, ": ", n.name, " = ", n.value, ", expected ",
                       n.may_be_zero && n.low > 0 ? "0 or " : "", n.low, " to ", n.high));
    }
    if (layer.conductivity_w_m_k == 0 && layer.density_kg_m3 * layer.specific_heat_j_kg_k == 0) {
      return absl::InvalidArgumentError(absl::StrCat(
          "layer ", i,
          ": conducts no heat (conductivity_w_m_k = 0) and stores none (density_kg_m3 = ",
          layer.density_kg_m3, ", specific_heat_j_kg_k = ", layer.specific_heat_j_kg_k,
          "): nothing determines its temperature"));
    }
  }
  return absl::OkStatus();
}

}  // namespace irsig
