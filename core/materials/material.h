#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "core/spectral/band.h"

namespace irsig {

struct OpticalConstant {
  double lambda_um, n, k;
};

enum class Fresnel { kExact, kSchlick };
enum class Masking { kVGroove, kSmith };

// Diffuse: brdf = (1 - emissivity(lambda)) / pi. One point: the same at every wavelength.
struct Lambert {
  std::vector<SpectralPoint>
      emissivity;  // linear between points; must cover the wavelengths asked for
};

// Beckmann microfacets (rms slope = roughness):                         [cook1982; zhou2026, eqs.
// 22-26, corrected]
//   brdf = c F(lambda, theta_d) D(theta_h) G / (4 cos_i cos_o)
struct CookTorrance {
  std::vector<OpticalConstant> constants;  // one: the same at every wavelength
  double roughness = 0.3;                  // rms slope m in [0.03, 1]
  Fresnel fresnel = Fresnel::kExact;
  Masking masking = Masking::kVGroove;
  // If >= 0: the lobe is scaled at each wavelength by c = (1 - normal_emissivity) / DHR(0), so that
  // the emissivity at normal incidence is this.
  double normal_emissivity = -1;
  // If >= 0: the emissivity is this constant whatever the lobe reflects. Creates energy
  // (`hull_paper`).
  double forced_emissivity = -1;
};

struct MaterialSpec {
  std::string name;
  std::variant<Lambert, CookTorrance> model;
};

// The ship's hull of [zhou2026] in three readings (its table contradicts itself: docs/methods.md):
// hull, hull_index, hull_paper.
[[nodiscard]] absl::StatusOr<MaterialSpec> builtin_material(const std::string& kind);

// Height-correlated Smith masking of Beckmann slopes of rms slope m. [heitz2014, eqs. 66, 99]
[[nodiscard]] double smith_masking(double cos_i, double cos_o, double m);

// A material prepared for a set of wavelengths ("nodes", in any order, all in [lambda_min_um,
// lambda_max_um]). Every model here factors into a geometric part and a spectral part,
//   brdf(lambda; w_i, w_o) = shape(w_i, w_o) * reflectance(lambda, cos_d),
// with cos_d the cosine between w_i and the half vector. `grey` materials have the same reflectance
// at every node.
//
// Directional emissivity = 1 - DHR, DHR by quadrature of the same factors, tabulated over sqrt(cos
// theta): error <= 5e-5 (tests/physics/material_test.cpp), and linear between table entries.
class Material {
 public:
  static absl::StatusOr<Material> prepare(const MaterialSpec& spec,
                                          const std::vector<double>& node_um, double lambda_min_um,
                                          double lambda_max_um);

  [[nodiscard]] bool grey() const { return grey_; }
  [[nodiscard]] float roughness() const { return roughness_; }  // 0: diffuse
  // Some wavelength and angle has DHR + emissivity > 1 + 1e-4.
  [[nodiscard]] bool creates_energy() const { return creates_energy_; }
  [[nodiscard]] std::size_t nodes() const { return nodes_; }

  // shape(w_i, w_o) from the cosines to the normal and the half vector: cos_h to the normal, cos_d
  // to either direction. [1/sr]
  [[nodiscard]] float shape_per_sr(float cos_i, float cos_o, float cos_h, float cos_d) const;

  struct Sampled {
    float x, y, z;  // unit direction in the local frame, z along the normal
    float cos_d;
    float weight;  // shape cos_i / density; 0: the direction lies below the surface
  };
  // A direction for w_o = (sin_o, 0, cos_o) in the local frame, from a number in (0, 1) and an
  // angle.
  [[nodiscard]] Sampled sample(float cos_o, float u, float cos_phi, float sin_phi) const;

  // Reflectance factor and emissivity of a grey material.
  [[nodiscard]] float reflectance(float cos_d) const {
    return lookup(reflectance_.data(), kFresnelCells, cos_d);
  }
  [[nodiscard]] float emissivity(float cos_o) const;
  // The largest DHR over the nodes: the survival probability of a path.
  [[nodiscard]] float dhr_max(float cos_o) const;
  // Both tables' values at an angle share their position.
  struct EmissivityAndDhr {
    float emissivity, dhr_max;
  };
  [[nodiscard]] EmissivityAndDhr emissivity_and_dhr(float cos_o) const {
    const float position = std::sqrt(cos_o) * static_cast<float>(kDhrCells);
    const int cell = std::min(static_cast<int>(position), kDhrCells - 1);
    const float t = position - static_cast<float>(cell);
    const float* entry = emissivity_dhr_.data() + 2 * cell;
    return {entry[0] + t * (entry[2] - entry[0]), entry[1] + t * (entry[3] - entry[1])};
  }

  // Spectral forms: one value for each node is written to out[0 .. nodes()).
  void spectral_reflectance(float cos_d, float* out) const;
  void spectral_emissivity(float cos_o, float* out) const;

  static constexpr int kFresnelCells = 1024;  // linear in cos_d
  static constexpr int kDhrCells = 256;       // linear in sqrt(cos)

 private:
  static float lookup(const float* table, int cells, float x) {
    const float position = x * static_cast<float>(cells);
    int cell = static_cast<int>(position);
    cell = cell < 0 ? 0 : (cell > cells - 1 ? cells - 1 : cell);
    const float t = position - static_cast<float>(cell);
    return table[cell] + t * (table[cell + 1] - table[cell]);
  }

  bool grey_ = true;
  bool creates_energy_ = false;
  std::size_t nodes_ = 0;
  float roughness_ = 0;  // 0: Lambert
  Masking masking_ = Masking::kVGroove;
  std::vector<float> reflectance_;           // [kFresnelCells + 1], grey
  std::vector<float> emissivity_dhr_;        // [kDhrCells + 1][2]: emissivity (grey), largest DHR
  std::vector<float> spectral_reflectance_;  // [cell][node], coarser in cos_d
  std::vector<float> spectral_emissivity_;   // [cell][node]
};

// The two functions that every reflection calls.

inline float Material::shape_per_sr(float cos_i, float cos_o, float cos_h, float cos_d) const {
  if (roughness_ == 0) return static_cast<float>(1.0 / std::numbers::pi);
  const float cos2 = cos_h * cos_h;
  const float m2 = roughness_ * roughness_;
  const float tan2 = (1.0f - cos2) / cos2;
  const float d = std::exp(-tan2 / m2) / (static_cast<float>(std::numbers::pi) * m2 * cos2 * cos2);
  if (masking_ == Masking::kVGroove) {
    // G / (cos_i cos_o) without cancellation at grazing
    const float smaller = std::min(cos_i, cos_o);
    const float larger = std::max(cos_i, cos_o);
    const float groove = 2.0f * cos_h / (cos_d * larger);
    return 0.25f * d * std::min(groove, 1.0f / (smaller * larger));
  }
  const auto g = static_cast<float>(smith_masking(cos_i, cos_o, roughness_));
  return 0.25f * d * g / (cos_i * cos_o);
}

inline Material::Sampled Material::sample(float cos_o, float u, float cos_phi,
                                          float sin_phi) const {
  if (roughness_ == 0) {  // cosine-weighted: weight = shape cos / (cos / pi) = 1
    const float r = std::sqrt(u);
    return {r * cos_phi, r * sin_phi, std::sqrt(std::max(0.0f, 1.0f - u)), 1.0f, 1.0f};
  }
  // Half vector with density D cos_h; direction density D cos_h / (4 cos_d).
  const float tan2 = -roughness_ * roughness_ * std::log(1.0f - u);
  const float cos_h = 1.0f / std::sqrt(1.0f + tan2);
  const float sin_h = std::sqrt(tan2) * cos_h;
  const float sin_o = std::sqrt(std::max(0.0f, 1.0f - cos_o * cos_o));
  const float hx = sin_h * cos_phi, hy = sin_h * sin_phi;
  const float cos_d = sin_o * hx + cos_o * cos_h;
  Sampled out{2 * cos_d * hx - sin_o, 2 * cos_d * hy, 2 * cos_d * cos_h - cos_o, cos_d, 0.0f};
  if (cos_d <= 0 || out.z <= 0) return out;
  out.cos_d = std::min(cos_d, 1.0f);
  if (masking_ == Masking::kVGroove)
    out.weight = std::min(cos_d / (cos_o * cos_h), 2.0f * std::min(out.z, cos_o) / cos_o);
  else
    out.weight =
        static_cast<float>(smith_masking(out.z, cos_o, roughness_)) * cos_d / (cos_o * cos_h);
  return out;
}

}  // namespace irsig
