#pragma once

#include "core/materials/brdf_model.h"

namespace irsig {

// Prepares Sandford and Robertson's BRDF of paints, made reciprocal. [1/sr]  [sandford1985]
//
//   g(theta) = 1 / (1 + b^2 tan^2 theta),  G = (1 + b^2 ln b^2 / (1 - b^2)) / (1 - b^2)
//   rho_S(theta) = 1 - (rho_D + epsilon) g(theta) / G
//   h = 1 / (e^2 cos_h^2 + sin_h^2)^2
//   f_r = rho_D g(i) g(o) / (pi G^2) + h s(i) s(o) / (4 pi)
//
// epsilon and rho_D are hemispherical values. As published the lobe is rho_S(i) h / (4 pi H(i)
// cos_o) with H such that its DHR is rho_S(i): not reciprocal. Here s is the function of one angle
// with which the reciprocal lobe has that same DHR, s(o) integral of h s(i) cos_i / (4 pi) dw_i =
// rho_S(o), found by symmetric scaling [knight2014]. So the directional emissivity is epsilon g / G
// as published, within 1e-5.
//
// Directions: half vectors of the ellipsoid h as w_o sees them, or cosine-weighted ones. Largest
// weight measured: 2.2 (brdf_sampling_test.cpp).
// Limits: e in [1e-4, 1], b in [0, 1), epsilon + rho_D <= G (else rho_S would be negative).
[[nodiscard]] BrdfModelOr prepare_sandford_robertson(const SandfordRobertson& spec,
                                                     const PreparedFor& at);

}  // namespace irsig
