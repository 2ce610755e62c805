#include "core/materials/material_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/materials/direction_check.h"
#include "core/materials/material.h"
#include "core/materials/tabulated_brdf.h"

namespace irsig {
namespace {

constexpr std::array<double, 7> kAnglesDeg = {0, 20, 40, 60, 75, 85, 89};
constexpr std::uint64_t kSeed = 20010;
constexpr std::uint32_t kDirections = 1u << 15;  // chi-square, per angle
constexpr std::uint32_t kPoints = 1u << 11, kReplicates = 16;

float cos_deg(double theta_deg) {
  // cos(x) would keep two digits in float at 90 deg - 1e-6 deg.
  return static_cast<float>(std::sin((90 - theta_deg) * std::numbers::pi / 180));
}

// Keeps the worst case of one row.
class Worst {
 public:
  Worst(std::string check, double bound) {
    row_.check = std::move(check);
    row_.bound = bound;
  }
  void see(double value, double theta_deg, double lambda_um = 0) {
    if (seen_ && std::isfinite(value) && !(value > row_.worst)) return;
    if (seen_ && !std::isfinite(row_.worst)) return;
    seen_ = true;
    row_.worst = value;
    row_.where = absl::StrCat(theta_deg, " deg");
    if (lambda_um > 0) absl::StrAppend(&row_.where, ", ", lambda_um, " um");
  }
  [[nodiscard]] MaterialCheckRow row() const {
    MaterialCheckRow out = row_;
    out.passed = out.worst <= out.bound;  // not a number fails
    return out;
  }

 private:
  MaterialCheckRow row_;
  bool seen_ = false;
};

MaterialCheckRow reciprocity(const Material& material, const std::vector<double>& lambda_um) {
  Worst worst("reciprocity", 1e-5);
  std::vector<float> there(lambda_um.size()), back(lambda_um.size());
  UniformNumbers random(mix64(kSeed));
  for (const double theta_deg : kAnglesDeg)
    for (int n = 0; n < 500; ++n) {
      const float u_lobe = random.next(), u = random.next();
      const float angle = 2 * std::numbers::pi_v<float> * random.next();
      const auto s =
          material.sample(cos_deg(theta_deg), u_lobe, u, std::cos(angle), std::sin(angle));
      if (!(s.z > 0)) continue;
      const Reflection turned{s.at.cos_o, s.at.cos_i, s.at.cos_h, s.at.sin2_h, s.at.cos_d};
      material.spectral_brdf_per_sr(s.at, there.data());
      material.spectral_brdf_per_sr(turned, back.data());
      for (std::size_t i = 0; i < lambda_um.size(); ++i)
        if (const float sum = there[i] + back[i]; sum > 0)
          worst.see(2 * static_cast<double>(std::abs(there[i] - back[i]) / sum), theta_deg,
                    lambda_um[i]);
    }
  return worst.row();
}

// DHR > 1 at any angle and wavelength, as a part of 1. The emissivity has no say in it.
MaterialCheckRow energy(const Material& material) {
  Worst worst("energy", 1e-4);
  for (double theta_deg = 0; theta_deg < 90; theta_deg += 0.25)
    worst.see(std::max(0.0f, material.dhr_max(cos_deg(theta_deg)) - 1.0f), theta_deg);
  for (const double left_deg : {0.1, 0.01, 1e-3, 1e-4, 1e-6})
    worst.see(std::max(0.0f, material.dhr_max(cos_deg(90 - left_deg)) - 1.0f), 90 - left_deg);
  return worst.row();
}

struct SampledDhr {
  std::vector<double> mean, stderr_of_mean;  // [wavelength]
};
SampledDhr sampled_dhr(const Material& material, float cos_o) {
  const std::size_t n = material.nodes();
  std::vector<double> sum(n, 0.0), sum2(n, 0.0), replicate(n);
  std::vector<float> weight(n);
  for (std::uint32_t r = 0; r < kReplicates; ++r) {
    std::fill(replicate.begin(), replicate.end(), 0.0);
    const std::uint64_t seed = mix64(kSeed + r);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const SamplePair lobe = sobol_pair(i, seed_pair(seed, 1)),
                       u = sobol_pair(i, seed_pair(seed, 0));
      const float angle = 2 * std::numbers::pi_v<float> * u.y;
      const auto s = material.sample(cos_o, lobe.x, u.x, std::cos(angle), std::sin(angle));
      if (!(s.weight > 0)) continue;
      material.spectral_weight(s, weight.data());
      for (std::size_t k = 0; k < n; ++k) replicate[k] += static_cast<double>(weight[k]) / kPoints;
    }
    for (std::size_t k = 0; k < n; ++k) {
      sum[k] += replicate[k] / kReplicates;
      sum2[k] += replicate[k] * replicate[k] / kReplicates;
    }
  }
  SampledDhr out{sum, std::vector<double>(n)};
  for (std::size_t k = 0; k < n; ++k)
    out.stderr_of_mean[k] = std::sqrt(std::max(0.0, sum2[k] - sum[k] * sum[k]) / (kReplicates - 1));
  return out;
}

MaterialCheckRow finiteness(const Material& material) {
  Worst worst("finite at grazing", 0);
  const std::vector<double> steep = {0, 45, 89, 89.9, 89.99, 89.9999, 90 - 1e-6};
  std::vector<float> row(material.nodes());
  UniformNumbers random(mix64(kSeed + 1));
  for (const double out_deg : steep) {
    double bad = 0;
    const auto count = [&](float value) { bad += std::isfinite(value) && value >= 0 ? 0 : 1; };
    const float cos_o = cos_deg(out_deg);
    material.spectral_emissivity(cos_o, row.data());
    for (const float e : row) count(e);
    count(material.dhr_max(cos_o));
    for (int n = 0; n < 300; ++n) {
      const float u_lobe = random.next(), u = random.next();
      const float angle = 2 * std::numbers::pi_v<float> * random.next();
      const auto s = material.sample(cos_o, u_lobe, u, std::cos(angle), std::sin(angle));
      count(s.weight);
      if (!(s.z > 0) || !(s.weight > 0)) continue;
      count(material.density_per_sr(s.at));
      material.spectral_weight(s, row.data());
      for (const float w : row) count(w);
    }
    for (const double in_deg : steep)
      for (int step = 0; step <= 18; ++step) {
        const double phi = step * std::numbers::pi / 18, ci = cos_deg(in_deg), co = cos_o;
        const double si = std::sqrt((1 - ci) * (1 + ci)), so = std::sqrt((1 - co) * (1 + co));
        const double hx = si * std::cos(phi) + so, hy = si * std::sin(phi), hz = ci + co;
        const double h2 = hx * hx + hy * hy + hz * hz;
        const Reflection at{static_cast<float>(ci), cos_o, static_cast<float>(hz / std::sqrt(h2)),
                            static_cast<float>((hx * hx + hy * hy) / h2),
                            static_cast<float>(std::min(1.0, 0.5 * std::sqrt(h2)))};
        if (!(at.cos_h > 0 && at.cos_d > 0)) continue;
        material.spectral_brdf_per_sr(at, row.data());
        for (const float f : row) count(f);
      }
    worst.see(bad, out_deg);
  }
  return worst.row();
}

}  // namespace

absl::StatusOr<std::vector<MaterialCheckRow>> check_material(const MaterialSpec& spec,
                                                             const std::vector<double>& lambda_um) {
  if (lambda_um.empty()) return absl::InvalidArgumentError("no wavelengths");
  const auto [least, most] = std::minmax_element(lambda_um.begin(), lambda_um.end());
  ASSIGN_OR_RETURN(const Material material, Material::prepare(spec, lambda_um, *least, *most));

  std::vector<MaterialCheckRow> rows{reciprocity(material, lambda_um), energy(material)};

  // Bounds: 5 standard errors and the tables' error, relative where DHR > 1.
  Worst closure("emissivity + DHR = 1", 1), table("sampled DHR = tabulated DHR", 1);
  std::vector<float> emissivity(lambda_um.size());
  for (const double theta_deg : kAnglesDeg) {
    const float cos_o = cos_deg(theta_deg);
    const SampledDhr sampled = sampled_dhr(material, cos_o);
    material.spectral_emissivity(cos_o, emissivity.data());
    std::size_t largest = 0;
    for (std::size_t i = 0; i < lambda_um.size(); ++i) {
      const double allowed = 5 * sampled.stderr_of_mean[i] + 1e-4 * std::max(1.0, sampled.mean[i]);
      closure.see(std::abs(static_cast<double>(emissivity[i]) + sampled.mean[i] - 1) / allowed,
                  theta_deg, lambda_um[i]);
      if (sampled.mean[i] > sampled.mean[largest]) largest = i;
    }
    const double allowed =
        5 * sampled.stderr_of_mean[largest] + 1e-4 * std::max(1.0, sampled.mean[largest]);
    table.see(
        std::abs(static_cast<double>(material.dhr_max(cos_o)) - sampled.mean[largest]) / allowed,
        theta_deg, lambda_um[largest]);
  }
  rows.push_back(closure.row());

  constexpr double kSigmaOfShare = 0.0028;  // sqrt(0.25 / kDirections)
  Worst integral("density integrates to the share above the surface", 5 * kSigmaOfShare);
  Worst chi_square("directions follow their density (1 - p)",
                   1 - 0.01 / static_cast<double>(kAnglesDeg.size()));
  for (const double theta_deg : kAnglesDeg) {
    const DirectionCheck test = check_directions(
        material, material, static_cast<double>(cos_deg(theta_deg)), kDirections, kSeed);
    integral.see(std::max(std::abs(test.integral - test.fraction_above),
                          test.integral > 1 + 2e-3 ? 1.0 : 0.0),
                 theta_deg);
    chi_square.see(1 - test.p_value, theta_deg);
  }
  rows.push_back(integral.row());
  rows.push_back(chi_square.row());
  rows.push_back(table.row());
  rows.push_back(finiteness(material));

  if (const auto* brdf = std::get_if<TabulatedBrdf>(&spec.model)) {
    ASSIGN_OR_RETURN(const auto findings, examine(*brdf));
    // Statements, not tests: the table is made reciprocal and continued as a constant whatever they
    // are.
    rows.push_back({"stated table: reciprocity residual before symmetrising (of its largest value)",
                    findings.reciprocity_residual, 1, true, "whole grid"});
    rows.push_back({"stated table: share of the hemisphere beyond its last zenith angle",
                    findings.clamped_fraction, 1, true,
                    absl::StrCat("beyond ", findings.last_zenith_deg, " deg")});
  }
  return rows;
}

}  // namespace irsig
