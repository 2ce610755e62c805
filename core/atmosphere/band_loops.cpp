#include "core/atmosphere/band_loops.h"

#include <cfloat>

#include "core/atmosphere/lane_math.h"
#include "core/base/clones.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

[[gnu::always_inline]] inline double decay_lane(double a, double b, double grey_depth) {
  const bool light = a > 0, more = b > 0;
  const double from = light ? a : 1.0;
  const double ratio = b / from;
  // One logarithm for both cases: b = 0 has fallen below DBL_MIN.
  const double ln = ln_lane(more ? ratio : from / DBL_MIN);
  const double change = ratio > 1 ? ratio - 1 : 1 - ratio;
  const double mean = change < 1e-4 ? 0.5 * (a + b) : (b - a) / ln;
  const double gone = a / (grey_depth > ln ? grey_depth : ln);
  return light ? (more ? mean : gone) : 0.0;
}

}  // namespace

IRSIG_CLONES void add_to_continuum(std::size_t n, const ContinuumBands& of, double ln_pressure,
                                   double temperature_k, double density, double length_m,
                                   double* depth) {
  const double *p0 = of.ln_pressure_pa, *t0 = of.temperature_k, *a = of.a, *b = of.b, *c = of.c,
               *k = of.k;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double x = temperature_k / t0[i] - 1;
    const double warm = 1 + b[i] * x + c[i] * x * x;
    depth[i] += k[i] * exp_lane(a[i] * (ln_pressure - p0[i])) * (warm > 0 ? warm : 0.0) * density *
                length_m;
  }
}

IRSIG_CLONES void grey_transmittance(std::size_t n, std::span<const double* const> depth,
                                     double* t) {
  for (std::size_t i = 0; i < n; ++i) t[i] = 0;
  for (const double* d : depth) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < n; ++i) t[i] += d[i];
  }
  for (std::size_t i = 0; i < n; ++i) t[i] = exp_lane(-t[i]);
}

IRSIG_CLONES void planck_bands(std::size_t n, const double* lambda_um, const double* scale,
                               double temperature_k, double* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    // The exponent is above 0.9 for air below 1000 K: next to nothing is lost to the -1.
    out[i] = scale[i] / (exp_lane(kC2UmK / (lambda_um[i] * temperature_k)) - 1);
  }
}

IRSIG_CLONES LevelQuantities between_levels(const LevelQuantities& a, const LevelQuantities& b,
                                            double fraction) {
  LevelQuantities out;
  for (std::size_t i = 0; i < kLevelQuantities; ++i) {
    const bool positive = (a[i] > 0) & (b[i] > 0);
    const double x = positive ? a[i] : 1.0, y = positive ? b[i] : 1.0;
    const double geometric = x * exp_lane(fraction * ln_lane(y / x));
    out[i] = positive ? geometric : a[i] + (b[i] - a[i]) * fraction;
  }
  return out;
}

IRSIG_CLONES void blended_exp(std::size_t n, const double* from, const double* to, double fraction,
                              double* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    out[i] = exp_lane(from[i] + fraction * (to[i] - from[i]));
  }
}

IRSIG_CLONES void add_emission_bands(std::size_t n, const StepBands& step, const double* t_near,
                                     const double* t_far, const double* planck_near,
                                     const double* planck_far, double* out) {
  const double *aerosol = step.aerosol_depth, *molecular = step.molecular_depth,
               *grey = step.grey_depth;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double near = t_near[i] > 0 ? t_near[i] : 1.0;
    const double through = t_far[i] / near, t = through < 1 ? through : 1.0;
    const double absorbed = 1 - t;
    const double least = (t_far[i] > DBL_MIN ? t_far[i] : DBL_MIN) / near;
    const double seen = -ln_lane(least < 1 ? least : 1.0);
    const double depth = seen > grey[i] ? seen : grey[i];
    const double nonzero = depth > 0 ? depth : 1.0;
    const double tilt = depth < 1e-3 ? depth * (0.5 - depth / 3) : absorbed / nonzero - t;
    const double share = 1 - (aerosol[i] + molecular[i]) / nonzero;
    const double emitted = t_near[i] * (share > 0 ? share : 0.0) *
                           (planck_near[i] * absorbed + (planck_far[i] - planck_near[i]) * tilt);
    out[i] += absorbed > 0 ? emitted : 0.0;
  }
}

IRSIG_CLONES void mean_of_decay_bands(std::size_t n, const double* a, const double* b,
                                      const double* grey_depth, double* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) out[i] = decay_lane(a[i], b[i], grey_depth[i]);
}

}  // namespace irsig
