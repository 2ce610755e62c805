#pragma once

#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/materials/brdf_model.h"
#include "core/materials/material_spec.h"
#include "core/materials/reflection.h"

namespace irsig {

// A material's BRDF by its equation, in double, at any wavelength; the tables of core/materials
// interpolate it. There is no emissivity: an integrator of radiance uses
//
//   L = B(T) + integral of f cos_i (L_in - B(T)) over the hemisphere
//
// which is Kirchhoff's law without a DHR. Equations and their sources:
// core/materials/material_spec.h and docs/explanation/methods/materials-*.md; this is an
// independent implementation. Two models are numerical solutions instead of formulas, the symmetric
// form of Sandford and Robertson and tabulated BRDFs. They come from core/materials, evaluated in
// double, and only at grey properties (UNIMPLEMENTED otherwise).
class ReferenceBrdf {
 public:
  // Creates the reference of a material. UNIMPLEMENTED: materials that the search does not generate
  // (a scaled lobe of constants that vary with wavelength; a forced emissivity).
  [[nodiscard]] static absl::StatusOr<ReferenceBrdf> make(const MaterialSpec& spec,
                                                          double lambda_min_um,
                                                          double lambda_max_um);

  // Returns true if the BRDF is the same at every wavelength.
  [[nodiscard]] bool grey() const { return grey_; }
  // Returns the rms slope of the narrowest lobe; infinite for a diffuse material.
  [[nodiscard]] double narrowest_slope() const { return narrowest_; }
  // Wavelengths between which a property is not smooth. [um]
  [[nodiscard]] const std::vector<double>& breaks_um() const { return breaks_; }

  // Computes the BRDF [1/sr] at each wavelength; out has the size of lambda_um.
  void brdf_per_sr(const ReflectionGeometry& g, std::span<const double> lambda_um,
                   std::span<double> out) const;

  struct Drawn {
    double x = 0, y = 0, z = 0;  // unit direction, z along the normal; w_o = (sin_o, 0, cos_o)
    ReflectionGeometry at{};
    double density_per_sr = 0;  // 0: below the surface
  };
  // Draws a direction from u_lobe, u and v, three numbers in [0, 1).
  [[nodiscard]] Drawn draw(double cos_o, double u_lobe, double u, double v) const;
  // Returns the density of draw(): positive wherever the BRDF is. [1/sr]
  [[nodiscard]] double density_per_sr(const ReflectionGeometry& g) const;

 private:
  struct HalfVectors {
    enum class Law { kBeckmann, kEllipsoid, kCauchy } law;
    double width, share;
  };
  MaterialSpec spec_;
  bool grey_ = true;
  double narrowest_ = 0, scale_ = 1;
  std::vector<double> breaks_;
  std::vector<HalfVectors> lobe_;
  double cosine_share_ = 0, uniform_share_ = 0;
  std::shared_ptr<const BrdfModel> solved_;
};

// Returns cos_i, cos_o and the half vector of two unit directions in the local frame (z along the
// normal).
[[nodiscard]] ReflectionGeometry geometry_between(const double in[3], const double out[3]);

}  // namespace irsig
