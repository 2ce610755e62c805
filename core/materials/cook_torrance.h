#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/materials/lobe_quadrature.h"
#include "core/materials/material_spec.h"

namespace irsig {

// Returns the height-correlated Smith masking of Beckmann slopes of rms slope m. [heitz2014, eqs.
// 66, 99]
[[nodiscard]] double smith_masking(double cos_i, double cos_o, double m);

// Tabulates the Fresnel reflectance at cos_d = (entry / cells)^2 for entry = 0 .. cells: dense
// where reflectance
// rises towards grazing and where the pseudo-Brewster dip of metals lies (at cos_d = 1 / |n + ik|).
// Linear between 512 entries: within 2e-5 up to |n + ik| = 32, 5e-5 at 25 + 90i. (256 entries
// linear in cos_d left 2e-3 and 1.3e-2.)
[[nodiscard]] std::vector<double> fresnel_table(const OpticalConstant& constants, Fresnel form,
                                                int cells);

// Returns the distribution of a lobe's reflection at one angle over cos_d: DHR(lambda) = sum over
// entries of moment x fresnel_table. `weight` is brdf cos_i / density of a direction drawn from the
// lobe, for F = 1.
template <typename Weight>
[[nodiscard]] std::vector<double> lobe_moments(const LobeQuadrature& quadrature, double cos_o,
                                               int cells, Weight&& weight) {
  std::vector<double> moments(static_cast<std::size_t>(cells) + 1, 0.0);
  quadrature.visit(cos_o, [&](const ReflectionGeometry& g, double mean_weight, double) {
    const double w = mean_weight * weight(g), position = std::sqrt(g.cos_d) * cells;
    const auto entry =
        std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(cells) - 1);
    const double t = position - static_cast<double>(entry);
    moments[entry] += w * (1 - t);
    moments[entry + 1] += w * t;
  });
  return moments;
}

[[nodiscard]] double dot(const std::vector<double>& moments, const std::vector<double>& table);

// Returns brdf cos_i / density of directions mirrored at Beckmann half vectors, for F = 1: G cos_d
// / (cos_o cos_h).
[[nodiscard]] double cook_torrance_weight(const ReflectionGeometry& g, double m, Masking masking);

// Returns V-groove masking min(1, 2 cos_h cos_i / cos_d, 2 cos_h cos_o / cos_d). [cook1982]
[[nodiscard]] double v_groove_masking(const ReflectionGeometry& g);

}  // namespace irsig
