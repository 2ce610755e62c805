#pragma once

#include "core/materials/reflection.h"

namespace irsig {

// A distribution of half vectors h about the normal, the same at all azimuths:
//
//   Beckmann   p = exp(-tan^2/w^2) / (pi w^2 cos^3)
//   ellipsoid  p = w^2 cos / (pi (w^2 cos^2 + sin^2)^2)
//   Cauchy     p = K cos / (w^2 cos^2 + sin^2),  K = (1 - w^2) / (pi ln(1/w^2))   [1/sr, of h]
//
// with cos, sin, tan of h's angle to the normal and the width w in [1e-4, 1] (Beckmann: any > 0).
// Directions mirrored at such half vectors have the density p / (4 cos_d).
enum class SlopeLaw { kBeckmann, kEllipsoid, kCauchy };

struct SlopeLobe {
  SlopeLaw law;
  double width;
};

// Returns the density of half vectors. [1/sr]
[[nodiscard]] double half_vector_density(const SlopeLobe& lobe, double cos_h, double sin2_h);

// Returns the largest exp(-t / w2) (1 + t)^power for t >= tan2.
[[nodiscard]] double largest_bell(double tan2, double w2, int power);

// Returns upper bounds, in a range of reflections, of the two factors by which brdf x cos_i of a
// lobe diverges at grazing: 1 / (4 cos_o) for the open lobe, and cos_h / (2 cos_d) <= 1 / (cos_i +
// cos_o) with V-grooves. Infinite where the range holds no limit.
[[nodiscard]] double open_grazing(const ReflectionRange& range);
[[nodiscard]] double groove_grazing(const ReflectionRange& range);

// Returns tan^2 of the angle that a fraction u in [0, 1) of the half vectors does not reach.
[[nodiscard]] double slope2_at(const SlopeLobe& lobe, double u);

}  // namespace irsig
