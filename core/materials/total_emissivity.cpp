#include "core/materials/total_emissivity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/materials/gauss_legendre.h"
#include "core/materials/material.h"
#include "core/materials/wavelength_range.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

constexpr int kWavelengths = 64;

// The middles of bands that have equal shares of a blackbody's flux.
std::vector<double> equal_shares_um(double temperature_k) {
  const double all = kStefanBoltzmannWM2K4 * std::pow(temperature_k, 4) / std::numbers::pi;
  std::vector<double> out;
  for (int i = 0; i < kWavelengths; ++i) {
    const double share = (i + 0.5) / kWavelengths;
    double low = std::log(100 / temperature_k), high = std::log(1e6 / temperature_k);
    for (int step = 0; step < 50; ++step) {
      const double middle = 0.5 * (low + high);
      const double below =
          planck_band_radiance_w_m2_sr(10 / temperature_k, std::exp(middle), temperature_k);
      (below < share * all ? low : high) = middle;
    }
    out.push_back(std::exp(0.5 * (low + high)));
  }
  return out;
}

}  // namespace

absl::StatusOr<TotalEmissivity> total_emissivity(const MaterialSpec& spec, double temperature_k) {
  const WavelengthRange table = wavelength_range(spec);
  std::vector<double> node_um = equal_shares_um(temperature_k);
  TotalEmissivity out{0, 0};
  for (double& um : node_um) {
    if (um >= table.min_um && um <= table.max_um) out.covered += 1.0 / kWavelengths;
    um = std::clamp(um, table.min_um, std::max(table.min_um, table.max_um));
  }
  ASSIGN_OR_RETURN(const auto material,
                   Material::prepare(spec, node_um, node_um.front(), node_um.back()));
  const QuadratureRule rule = gauss_legendre(16);
  std::vector<float> emissivity(material.nodes());
  for (std::size_t i = 0; i < rule.x.size(); ++i) {
    const auto cosine = static_cast<float>(rule.x[i]);
    const double weight = 2 * rule.x[i] * rule.w[i];
    if (material.grey()) {
      out.value += weight * static_cast<double>(material.emissivity(cosine));
      continue;
    }
    material.spectral_emissivity(cosine, emissivity.data());
    for (const float e : emissivity) out.value += weight * static_cast<double>(e) / kWavelengths;
  }
  out.value = std::clamp(out.value, 0.0, 1.0);
  return out;
}

}  // namespace irsig
