#include "core/materials/beard_maxwell.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/status_macros.h"
#include "core/materials/cook_torrance.h"
#include "core/materials/lobe_mixture.h"
#include "core/materials/lobe_quadrature.h"
#include "core/materials/spectra.h"

namespace irsig {
namespace {

constexpr int kCells = 512;

class BeardMaxwellModel final : public LobeModel {
 public:
  BeardMaxwellModel(const BeardMaxwell& spec, std::size_t spectra,
                    const std::vector<double>& node_um)
      : LobeModel(spectra),
        spec_(spec),
        lobe_{SlopeLaw::kCauchy, spec.width},
        quadrature_(lobe_, 32, 16) {
    double most_diffuse = 0, most_volume = 0;
    for (std::size_t i = 0; i < spectra; ++i) {
      const OpticalConstant c = constants_at(spec.constants, node_um[i]);
      fresnel_.push_back(fresnel_table(c, Fresnel::kExact, kCells));
      diffuse_.push_back(spectrum_at(spec.diffuse, node_um[i]));
      volume_.push_back(spectrum_at(spec.volume, node_um[i]));
      most_diffuse = std::max(most_diffuse, diffuse_.back());
      most_volume = std::max(most_volume, volume_.back());
    }
    for (int entry = 0; entry <= kCells; ++entry)
      for (std::size_t i = 0; i < spectra; ++i)
        fresnel_row_.push_back(static_cast<float>(fresnel_[i][static_cast<std::size_t>(entry)]));
    set_lobes({{SamplingLobe::Kind::kHalfVectors, lobe_},
               {SamplingLobe::Kind::kCosine},
               {SamplingLobe::Kind::kUniform}},
              [&](double cos_o, std::span<double> out) {
                const auto first = moments(cos_o);
                double most = 0;
                for (const auto& f : fresnel_) most = std::max(most, dot(first, f));
                out[0] = most;
                out[1] = most_diffuse;
                out[2] = most_volume * volume_dhr(cos_o);
              });
  }

  void brdf_per_sr(const ReflectionGeometry& g, float* out) const override {
    const double tan2 = g.sin2_h / (g.cos_h * g.cos_h);
    const double d = spec_.bias / (g.cos_h * (spec_.width * spec_.width + tan2));
    const double first = 0.25 * d * masking(g) / (g.cos_i * g.cos_o);
    const double volume = 2 / (std::numbers::pi * (g.cos_i + g.cos_o));
    const double position = std::sqrt(g.cos_d) * kCells;
    const auto entry =
        std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(kCells) - 1);
    const auto t = static_cast<float>(position - static_cast<double>(entry));
    const float* a = fresnel_row_.data() + entry * spectra();
    const float* b = a + spectra();
    for (std::size_t i = 0; i < spectra(); ++i)
      out[i] = static_cast<float>(first * (a[i] + t * (b[i] - a[i])) +
                                  diffuse_[i] / std::numbers::pi + volume_[i] * volume);
  }

  void dhr(double cos_o, std::span<double> out) const override {
    const auto first = moments(cos_o);
    const double volume = volume_dhr(cos_o);
    for (std::size_t i = 0; i < spectra(); ++i)
      out[i] = dot(first, fresnel_[i]) + diffuse_[i] + volume_[i] * volume;
  }

  // sqrt(1 + t) / (w^2 + t) falls with t = tan^2; the volume's part is at most 2 / pi.
  [[nodiscard]] double cos_brdf_limit_per_sr(const ReflectionRange& range) const override {
    const double t = range.tan2_h_min;
    const double d = spec_.bias * std::sqrt(1 + t) / (spec_.width * spec_.width + t);
    const auto entry =
        static_cast<std::ptrdiff_t>(std::sqrt(std::clamp(range.cos_d_min(), 0.0, 1.0)) * kCells);
    const float fresnel = *std::max_element(
        fresnel_row_.begin() + entry * static_cast<std::ptrdiff_t>(spectra()), fresnel_row_.end());
    return d * static_cast<double>(fresnel) *
               (spec_.published ? open_grazing(range) : groove_grazing(range)) +
           *std::max_element(diffuse_.begin(), diffuse_.end()) / std::numbers::pi +
           2 / std::numbers::pi * *std::max_element(volume_.begin(), volume_.end());
  }

  [[nodiscard]] double narrowest_slope() const override { return spec_.width; }
  [[nodiscard]] double roulette_slope2() const override { return 0; }  // the lobe's tail is heavy

 private:
  [[nodiscard]] double masking(const ReflectionGeometry& g) const {
    constexpr double kDegrees = 180 / std::numbers::pi;
    const double theta = std::atan2(std::sqrt(g.sin2_h), g.cos_h) * kDegrees / spec_.omega_deg;
    const double beta = std::acos(std::min(1.0, g.cos_d)) * kDegrees;
    const double so = (1 + theta * std::exp(-2 * beta / spec_.tau_deg)) / (1 + theta);
    return spec_.published ? so : std::min(so, v_groove_masking(g));
  }

  [[nodiscard]] std::vector<double> moments(double cos_o) const {
    // brdf cos_i / density: D SO cos_d / (cos_o p).
    return lobe_moments(quadrature_, cos_o, kCells, [&](const ReflectionGeometry& g) {
      const double p = half_vector_density(lobe_, g.cos_h, g.sin2_h);
      const double tan2 = g.sin2_h / (g.cos_h * g.cos_h);
      const double d = spec_.bias / (g.cos_h * (spec_.width * spec_.width + tan2));
      return d / p * masking(g) * g.cos_d / cos_o;
    });
  }

  // 4 (1 - c ln((1 + c) / c))
  static double volume_dhr(double c) { return 4 * (1 - c * std::log1p(1 / c)); }

  BeardMaxwell spec_;
  SlopeLobe lobe_;
  LobeQuadrature quadrature_;
  std::vector<std::vector<double>> fresnel_;  // [spectrum][entry]
  std::vector<float> fresnel_row_;            // [entry][spectrum]
  std::vector<double> diffuse_, volume_;
};

}  // namespace

double beard_maxwell_normalised_bias(double width) {
  // 1 / (2 pi integral of sin / (sigma^2 + tan^2)); with c = cos: c^2 / (1 - kappa c^2), kappa = 1
  // - sigma^2, from 0 to 1.
  const double kappa = 1 - width * width;
  double integral = 0;
  if (kappa < 1e-2) {
    double power = 1;
    for (int n = 0; n < 12; ++n, power *= kappa) integral += power / (2 * n + 3);
  } else {
    const double root = std::sqrt(kappa);
    // atanh(root) = ln((1 + root) / (1 - root)) / 2 with 1 - root = sigma^2 / (1 + root)
    integral = (std::log((1 + root) / width) / root - 1) / kappa;
  }
  return 1 / (2 * std::numbers::pi * integral);
}

BrdfModelOr prepare_beard_maxwell(const BeardMaxwell& spec, const PreparedFor& at) {
  RETURN_IF_ERROR(first_failure(
      {check_covers(spec.constants, at.lambda_min_um, at.lambda_max_um),
       check_fraction(spec.diffuse, "diffuse reflectance", at.lambda_min_um, at.lambda_max_um),
       check_fraction(spec.volume, "volume reflectance", at.lambda_min_um, at.lambda_max_um),
       check_between(spec.width, "width", 1e-4, 1), check_between(spec.bias, "bias", 0, 1e9),
       check_between(spec.tau_deg, "tau", 1e-3, 1e6),
       check_between(spec.omega_deg, "omega", 1e-3, 1e6)}));
  const bool grey =
      spec.constants.size() == 1 && spec.diffuse.size() == 1 && spec.volume.size() == 1;
  return std::make_shared<const BeardMaxwellModel>(spec, grey ? 1 : at.node_um.size(), at.node_um);
}

}  // namespace irsig
