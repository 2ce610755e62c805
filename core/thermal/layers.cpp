#include "core/thermal/layers.h"

#include <cmath>
#include <cstddef>

#include "absl/strings/str_cat.h"

namespace irsig {

absl::Status check_layers(std::span<const Layer> layers) {
  if (layers.empty()) return absl::InvalidArgumentError("a wall needs at least one layer");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Layer& layer = layers[i];
    const auto wrong = [i](const char* name, double value, const char* expected) {
      return absl::InvalidArgumentError(
          absl::StrCat("layer ", i, ": ", name, " = ", value, ", expected ", expected));
    };
    if (!(layer.thickness_m > 0 && std::isfinite(layer.thickness_m))) {
      return wrong("thickness_m", layer.thickness_m, "a positive number");
    }
    for (const auto& [name, value] : {std::pair{"conductivity_w_m_k", layer.conductivity_w_m_k},
                                      std::pair{"density_kg_m3", layer.density_kg_m3},
                                      std::pair{"specific_heat_j_kg_k", layer.specific_heat_j_kg_k}}) {
      if (!(value >= 0 && std::isfinite(value))) return wrong(name, value, "a number >= 0");
    }
    if (layer.conductivity_w_m_k == 0 && layer.density_kg_m3 * layer.specific_heat_j_kg_k == 0) {
      return absl::InvalidArgumentError(absl::StrCat(
          "layer ", i, ": conducts no heat (conductivity_w_m_k = 0) and stores none (density_kg_m3 = ",
          layer.density_kg_m3, ", specific_heat_j_kg_k = ", layer.specific_heat_j_kg_k,
          "): nothing determines its temperature"));
    }
  }
  return absl::OkStatus();
}

}  // namespace irsig
