#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/materials/cook_torrance.h"
#include "core/materials/material_spec.h"
#include "core/materials/reflection.h"
#include "core/materials/thrown_light.h"

namespace irsig {

class BrdfModel;
struct DhrTable;

// Returns the ship's hull of [zhou2026] in three readings, since its table contradicts itself
// (docs/explanation/methods.md): hull, hull_index, hull_paper.
[[nodiscard]] absl::StatusOr<MaterialSpec> builtin_material(const std::string& kind);

// Returns scalar Priest-Germer as its Cook-Torrance lobe: m = sqrt(2) sigma, exact Fresnel, no
// masking as published, or that of V-grooves.
[[nodiscard]] CookTorrance as_cook_torrance(const PriestGermer& spec);

// A material prepared for a set of wavelengths ("nodes", in any order, all in [lambda_min_um,
// lambda_max_um]). `grey` materials are the same at every node.
//
// Directional emissivity = 1 - DHR. DHR comes from quadrature and is tabulated over sqrt(cos theta)
// as finely as its curvature needs: 0 to 89 deg within 3e-5 of independent quadrature
// (tests/physics/brdf_dhr_test.cpp), finite to 90 deg - 1e-6 deg. Where DHR > 1 the emissivity is
// 0 and creates_energy() says so.
//
// Directions are drawn with a density that depends on geometry and material only; it is positive
// wherever the BRDF is positive at any node.
class Material {
 public:
  static absl::StatusOr<Material> prepare(const MaterialSpec& spec,
                                          const std::vector<double>& node_um, double lambda_min_um,
                                          double lambda_max_um);

  [[nodiscard]] bool grey() const { return grey_; }
  // Returns true if DHR + emissivity > 1 + 1e-4 at some wavelength and angle.
  [[nodiscard]] bool creates_energy() const { return creates_energy_; }
  [[nodiscard]] std::size_t nodes() const { return nodes_; }
  // Returns the rms slope of the narrowest lobe; infinite for diffuse materials. Light sources that
  // are not much wider than the lobe are better met by drawn directions than aimed at.
  [[nodiscard]] float narrowest_slope() const { return narrowest_slope_; }
  // Returns m^2 of a Beckmann lobe that is nowhere much below the material's brdf / its diffuse
  // equivalent: how probable it is that a small light matters. 0: as for a diffuse material.
  [[nodiscard]] float roulette_slope2() const { return roulette_slope2_; }

  // Returns an upper bound of brdf x cos_i at all nodes, for all reflections of a range, proven for
  // each model (docs/explanation/methods/README.md, "The largest reflection"); infinite where a
  // model has no limit there. [1/sr]
  [[nodiscard]] double cos_brdf_limit_per_sr(const ReflectionRange& range) const;
  // Returns upper bounds of brdf x cos_i for light of the given cosines and any view direction
  // (limit_of_light_per_sr), and for view directions of the given cosines and any light
  // (limit_seen_per_sr). [1/sr]
  [[nodiscard]] double limit_of_light_per_sr(double cos_i_min, double cos_i_max) const;
  [[nodiscard]] double limit_seen_per_sr(double cos_o_min, double cos_o_max) const;
  // Says how much of the reflected light is how bright, at its largest node.
  [[nodiscard]] const ThrownLight& thrown_light() const { return thrown_light_; }

  // Returns the BRDF of a grey material. [1/sr]
  [[nodiscard]] float brdf_per_sr(const Reflection& r) const;
  // Returns the probability density of sample(), which does not depend on wavelength. [1/sr]
  [[nodiscard]] float density_per_sr(const Reflection& r) const;

  struct Sampled {
    float x, y, z;  // unit direction in the local frame, z along the normal
    Reflection at;
    float weight;  // grey: brdf cos_i / density; otherwise > 0; 0: the direction lies below the
                   // surface
  };
  // Draws a direction for w_o = (sin_o, 0, cos_o) in the local frame.
  //   u_lobe  chooses the lobe
  //   u, phi  in (0, 1) and an angle: the place in the lobe
  [[nodiscard]] Sampled sample(float cos_o, float u_lobe, float u, float cos_phi,
                               float sin_phi) const;

  [[nodiscard]] float emissivity(float cos_o) const { return emissivity_and_dhr(cos_o).emissivity; }
  // Returns the largest DHR over the nodes: the survival probability of a path.
  [[nodiscard]] float dhr_max(float cos_o) const { return emissivity_and_dhr(cos_o).dhr_max; }
  // Both tables' values at an angle share their position.
  struct EmissivityAndDhr {
    float emissivity, dhr_max;
  };
  [[nodiscard]] EmissivityAndDhr emissivity_and_dhr(float cos_o) const {
    const float position = std::sqrt(cos_o) * static_cast<float>(dhr_cells_);
    const int cell = std::min(static_cast<int>(position), dhr_cells_ - 1);
    const float t = position - static_cast<float>(cell);
    const float* entry = emissivity_dhr_.data() + 2 * cell;
    return {entry[0] + t * (entry[2] - entry[0]), entry[1] + t * (entry[3] - entry[1])};
  }

  // Writes the spectral forms, one value for each node, to out[0 .. nodes()).
  void spectral_brdf_per_sr(const Reflection& r, float* out) const;
  void spectral_weight(const Sampled& s, float* out) const;  // brdf cos_i / density
  void spectral_emissivity(float cos_o, float* out) const;

  static constexpr int kFresnelCells = 1024;         // of a grey material, linear in sqrt(cos_d)
  static constexpr int kSpectralFresnelCells = 512;  // of the others

 private:
  absl::Status prepare_lambert(const Lambert& spec, const std::vector<double>& node_um,
                               double lambda_min_um, double lambda_max_um);
  absl::Status prepare_cook_torrance(const CookTorrance& spec, const std::vector<double>& node_um,
                                     double lambda_min_um, double lambda_max_um);
  absl::Status prepare_model(const MaterialSpec& spec, const std::vector<double>& node_um,
                             double lambda_min_um, double lambda_max_um);
  // Sets the tables of DHR and emissivity. forced_emissivity < 0: the emissivity is 1 - DHR.
  void set_tables(const DhrTable& dhr, double forced_emissivity);
  [[nodiscard]] float model_brdf_per_sr(const Reflection& r) const;
  [[nodiscard]] float model_density_per_sr(const Reflection& r) const;
  [[nodiscard]] Sampled model_sample(float cos_o, float u_lobe, float u, float cos_phi,
                                     float sin_phi) const;
  static float lookup(const float* table, int cells, float x) {
    const float position = x * static_cast<float>(cells);
    int cell = static_cast<int>(position);
    cell = cell < 0 ? 0 : (cell > cells - 1 ? cells - 1 : cell);
    const float t = position - static_cast<float>(cell);
    return table[cell] + t * (table[cell + 1] - table[cell]);
  }
  [[nodiscard]] float reflectance(float cos_d) const {
    return lookup(reflectance_.data(), kFresnelCells, std::sqrt(cos_d));
  }
  void spectral_reflectance(float cos_d, float* out) const;
  [[nodiscard]] float shape_per_sr(const Reflection& r) const;

  bool grey_ = true;
  bool creates_energy_ = false;
  std::size_t nodes_ = 0;
  float narrowest_slope_ = 0, roulette_slope2_ = 0;
  int dhr_cells_ = 1;
  std::vector<float> emissivity_dhr_;       // [dhr_cells_ + 1][2]: emissivity (grey), largest DHR
  std::vector<float> spectral_emissivity_;  // [cell][node]

  // Sets the limits. Lambert and Cook-Torrance factor into brdf = shape(geometry) x
  // reflectance(lambda, cos_d).
  void set_limits();
  [[nodiscard]] double lobe_limit_per_sr(const ReflectionRange& range) const;

  // [entry of sqrt(cos_d)]: the largest reflectance from there on, at any node.
  std::vector<float> largest_reflectance_;
  std::vector<double> limit_of_light_, limit_seen_;  // [kLimitCells of the angle]
  ThrownLight thrown_light_;
  float roughness_ = 0;  // 0: Lambert; below 0: the other models
  Masking masking_ = Masking::kVGroove;
  std::vector<float> reflectance_;           // [kFresnelCells + 1], grey
  std::vector<float> spectral_reflectance_;  // [kSpectralFresnelCells + 1][node]
  std::shared_ptr<const BrdfModel> model_;   // the others
};

// Every reflection calls this function.

inline float Material::shape_per_sr(const Reflection& r) const {
  if (roughness_ <= 0) return static_cast<float>(1.0 / std::numbers::pi);
  const float cos2 = r.cos_h * r.cos_h;
  const float m2 = roughness_ * roughness_;
  const float tan2 = r.sin2_h / cos2;
  const float d = std::exp(-tan2 / m2) / (static_cast<float>(std::numbers::pi) * m2 * cos2 * cos2);
  if (masking_ == Masking::kVGroove) {
    // G / (cos_i cos_o) without cancellation at grazing
    const float smaller = std::min(r.cos_i, r.cos_o);
    const float larger = std::max(r.cos_i, r.cos_o);
    const float groove = 2.0f * r.cos_h / (r.cos_d * larger);
    return 0.25f * d * std::min(groove, 1.0f / (smaller * larger));
  }
  const auto g = masking_ == Masking::kNone
                     ? 1.0f
                     : static_cast<float>(smith_masking(r.cos_i, r.cos_o, roughness_));
  return 0.25f * d * g / (r.cos_i * r.cos_o);
}

inline float Material::brdf_per_sr(const Reflection& r) const {
  if (roughness_ < 0) return model_brdf_per_sr(r);
  return shape_per_sr(r) * reflectance(r.cos_d);
}

inline float Material::density_per_sr(const Reflection& r) const {
  if (roughness_ <= 0)
    return roughness_ < 0 ? model_density_per_sr(r)
                          : r.cos_i * static_cast<float>(1.0 / std::numbers::pi);
  const float cos2 = r.cos_h * r.cos_h;
  const float m2 = roughness_ * roughness_;
  return std::exp(-r.sin2_h / (cos2 * m2)) /
         (static_cast<float>(4 * std::numbers::pi) * m2 * cos2 * r.cos_h * r.cos_d);
}

inline Material::Sampled Material::sample(float cos_o, float u_lobe, float u, float cos_phi,
                                          float sin_phi) const {
  if (roughness_ < 0) return model_sample(cos_o, u_lobe, u, cos_phi, sin_phi);
  if (roughness_ == 0) {  // cosine-weighted
    const float r = std::sqrt(u);
    const float cos_i = std::sqrt(std::max(0.0f, 1.0f - u));
    return {r * cos_phi, r * sin_phi, cos_i, {cos_i, cos_o, 1, 0, 1}, grey_ ? reflectance(1) : 1};
  }
  // Half vector with density D cos_h; direction density D cos_h / (4 cos_d).
  const float tan2 = -roughness_ * roughness_ * std::log(1.0f - u);
  const float cos_h = 1.0f / std::sqrt(1.0f + tan2);
  const float sin_h = std::sqrt(tan2) * cos_h;
  const float sin_o = std::sqrt(std::max(0.0f, 1.0f - cos_o * cos_o));
  const float hx = sin_h * cos_phi, hy = sin_h * sin_phi;
  const float cos_d = sin_o * hx + cos_o * cos_h;
  Sampled out{2 * cos_d * hx - sin_o, 2 * cos_d * hy, 2 * cos_d * cos_h - cos_o, {}, 0.0f};
  if (cos_d <= 0 || out.z <= 0) return out;
  out.at = {out.z, cos_o, cos_h, sin_h * sin_h, std::min(cos_d, 1.0f)};
  if (masking_ == Masking::kVGroove)
    out.weight = std::min(cos_d / (cos_o * cos_h), 2.0f * std::min(out.z, cos_o) / cos_o);
  else
    out.weight =
        cos_d / (cos_o * cos_h) *
        (masking_ == Masking::kNone ? 1.0f
                                    : static_cast<float>(smith_masking(out.z, cos_o, roughness_)));
  if (grey_) out.weight *= reflectance(out.at.cos_d);
  return out;
}

}  // namespace irsig
