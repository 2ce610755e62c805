#pragma once

#include "core/materials/brdf_model.h"

namespace irsig {

// Prepares the Beard-Maxwell BRDF with the parameters of the NEF database. [1/sr]
// [maxwell1973; westlund2002]
//
//   f_r = F(lambda, cos_d) D SO / (4 cos_i cos_o) + rho_d / pi + 2 rho_v / (pi (cos_i + cos_o))
//   D  = B / (cos_h (sigma^2 + tan_h^2))
//   SO = (1 + (theta_h / Omega) exp(-2 beta / tau)) / (1 + theta_h / Omega)
//
// theta_h, beta: the half vector's angles to the normal and to either direction; F: exact Fresnel.
// rho_d and rho_v are pi x the database's values in 1/sr. As published SO does not fall at grazing
// and energy is created there; by default SO is replaced by V-groove masking where that is smaller,
// which bounds the first surface by B / beard_maxwell_normalised_bias(sigma).
//
// Directions: half vectors of the Cauchy law, uniform ones for rho_v, cosine-weighted ones for
// rho_d. Largest weight, each divided by the lobe's probability: 2 B / K (slope_law.h), 4 rho_v,
// rho_d; as published the first is (B / K) / cos_o.
// Limits: sigma in [1e-4, 1], tau and Omega > 0; rho_v alone reflects 4 rho_v at grazing, and
// creates_energy() says so.
[[nodiscard]] BrdfModelOr prepare_beard_maxwell(const BeardMaxwell& spec, const PreparedFor& at);

// Returns the B for which the projected area of the facets, the integral of D cos_h, is that of the
// surface.
[[nodiscard]] double beard_maxwell_normalised_bias(double width);

}  // namespace irsig
