#include "cli/material_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/base/status_macros.h"
#include "core/materials/optical/angular_table.h"
#include "view/plot/plot_curves.h"

namespace irsig {
namespace {

constexpr std::size_t kWavelengths = 160;
constexpr std::array kAngles{0.0, 45.0, 60.0, 75.0, 85.0};

Curve curve(const std::vector<AngularValue>& values, std::size_t first, std::size_t stride,
            std::size_t count, const std::string& name, bool against_angle, bool dhr) {
  Curve out{name, {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const AngularValue& v = values[first + i * stride];
    out.x.push_back(against_angle ? v.theta_i_deg : v.lambda_um);
    out.y.push_back(dhr ? v.dhr : v.emissivity);
  }
  return out;
}

}  // namespace

absl::StatusOr<std::string> plot_material(const ChosenMaterial& material) {
  std::vector<double> fine_deg, fine_um;
  for (int i = 0; i <= 179; ++i) fine_deg.push_back(0.5 * i);
  for (std::size_t i = 0; i < kWavelengths; ++i)
    fine_um.push_back(material.min_um + (material.max_um - material.min_um) *
                                            static_cast<double>(i) / (kWavelengths - 1));
  const std::vector<double> angles(kAngles.begin(), kAngles.end());
  ASSIGN_OR_RETURN(const auto over_angle,
                   angular_table(material.spec, material.lambda_um, fine_deg));
  ASSIGN_OR_RETURN(const auto over_um, angular_table(material.spec, fine_um, angles));

  std::vector<CurvePanel> panels;
  double top = 1;
  for (const AngularValue& v : over_angle.value) top = std::max(top, v.dhr);
  for (const AngularValue& v : over_um.value) top = std::max(top, v.dhr);
  for (const bool dhr : {true, false}) {
    const std::string what =
        dhr ? "Directional-hemispherical reflectance" : "Directional emissivity";
    const double high = dhr ? top : 1;
    CurvePanel angle{
        what + " against angle", "Angle from the normal in degrees", what, {}, 0, high};
    for (std::size_t i = 0; i < material.lambda_um.size(); ++i)
      angle.curve.push_back(curve(over_angle.value, i * fine_deg.size(), 1, fine_deg.size(),
                                  fmt::format("{:.4g} \u00b5m", material.lambda_um[i]), true, dhr));
    CurvePanel spectral{what + " against wavelength", "Wavelength in \u00b5m", what, {}, 0, high};
    for (std::size_t t = 0; t < angles.size(); ++t)
      spectral.curve.push_back(curve(over_um.value, t, angles.size(), fine_um.size(),
                                     fmt::format("{:g}\u00b0", angles[t]), false, dhr));
    panels.push_back(std::move(angle));
    panels.push_back(std::move(spectral));
  }
  const std::string kind = model_kind(material.spec);
  return plot_curves(
      material.spec.name,
      material.entry.description.empty()
          ? kind + (over_angle.creates_energy || over_um.creates_energy ? ", creates energy" : "")
          : material.entry.description,
      panels, 2);
}

}  // namespace irsig
