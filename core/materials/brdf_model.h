#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"
#include "core/materials/reflection.h"

namespace irsig {

// A BRDF prepared for wavelengths, as Material tabulates and samples it. Every model but Lambert
// and Cook-Torrance, which Material computes without a virtual call, is one of these.
class BrdfModel {
 public:
  struct Drawn {
    double x = 0, y = 0, z = 0;  // unit direction in the frame of Material::sample
    ReflectionGeometry at{};
    double density_per_sr = 0;  // 0: the direction lies below the surface
  };

  virtual ~BrdfModel() = default;

  // Returns the number of spectra: 1 if grey, otherwise one for each wavelength.
  [[nodiscard]] virtual std::size_t spectra() const = 0;
  // Writes the BRDF of each spectrum. [1/sr]
  virtual void brdf_per_sr(const ReflectionGeometry& g, float* out) const = 0;
  // Computes, for each spectrum, the integral of brdf cos_i over w_i.
  virtual void dhr(double cos_o, std::span<double> out) const = 0;

  // Returns a drawn direction for w_o = (sin_o, 0, cos_o), and the density of such draws. [1/sr]
  [[nodiscard]] virtual Drawn sample(double cos_o, double u_lobe, double u, double cos_phi,
                                     double sin_phi) const = 0;
  [[nodiscard]] virtual double density_per_sr(const ReflectionGeometry& g) const = 0;

  // Returns the limit of Material::cos_brdf_limit_per_sr(). [1/sr]
  [[nodiscard]] virtual double cos_brdf_limit_per_sr(const ReflectionRange& range) const = 0;

  // Returns the slopes of Material::narrowest_slope() and Material::roulette_slope2().
  [[nodiscard]] virtual double narrowest_slope() const = 0;
  [[nodiscard]] virtual double roulette_slope2() const = 0;
};

// The wavelengths for which a model is prepared.
struct PreparedFor {
  std::vector<double> node_um;
  double lambda_min_um, lambda_max_um;
};

using BrdfModelOr = absl::StatusOr<std::shared_ptr<const BrdfModel>>;

}  // namespace irsig
