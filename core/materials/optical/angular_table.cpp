#include "core/materials/optical/angular_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/materials/material.h"

namespace irsig {
namespace {

float cosine(double theta_deg) {
  return std::max(0.0f, static_cast<float>(std::cos(theta_deg * std::numbers::pi / 180)));
}

}  // namespace

absl::StatusOr<AngularTable> angular_table(const MaterialSpec& spec,
                                           const std::vector<double>& lambda_um,
                                           const std::vector<double>& theta_i_deg) {
  if (lambda_um.empty() || theta_i_deg.empty())
    return absl::InvalidArgumentError("no wavelength or no angle");
  for (const double theta : theta_i_deg)
    if (!(theta >= 0 && theta <= 90))
      return absl::InvalidArgumentError(
          absl::StrCat("an angle of ", theta, " degrees, expected 0 to 90"));
  const auto [least, most] = std::minmax_element(lambda_um.begin(), lambda_um.end());
  ASSIGN_OR_RETURN(const auto material, Material::prepare(spec, lambda_um, *least, *most));
  AngularTable out;
  out.creates_energy = material.creates_energy();
  out.value.resize(lambda_um.size() * theta_i_deg.size());
  std::vector<float> emissivity(lambda_um.size());
  for (std::size_t t = 0; t < theta_i_deg.size(); ++t) {
    material.spectral_emissivity(cosine(theta_i_deg[t]), emissivity.data());
    for (std::size_t i = 0; i < lambda_um.size(); ++i) {
      const double e = static_cast<double>(emissivity[i]);
      out.value[i * theta_i_deg.size() + t] = {lambda_um[i], theta_i_deg[t], 1 - e, e};
    }
  }
  if (!out.creates_energy) return out;
  // DHR and emissivity do not add up to 1: each wavelength alone has its own DHR as the largest.
  for (std::size_t i = 0; i < lambda_um.size(); ++i) {
    ASSIGN_OR_RETURN(const auto one,
                     Material::prepare(spec, {lambda_um[i]}, lambda_um[i], lambda_um[i]));
    for (std::size_t t = 0; t < theta_i_deg.size(); ++t)
      out.value[i * theta_i_deg.size() + t].dhr =
          static_cast<double>(one.dhr_max(cosine(theta_i_deg[t])));
  }
  return out;
}

}  // namespace irsig
