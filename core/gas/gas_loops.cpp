#include "core/gas/gas_loops.h"

#include <cmath>

#include "core/atmosphere/lane_math.h"
#include "core/base/clones.h"
#include "core/base/constants.h"
#include "core/gas/narrow_band_tables.h"
#include "core/gas/step.h"

namespace irsig {
namespace {

#define IRSIG_LANE [[gnu::always_inline]] inline

IRSIG_LANE Step log1p_step(Step a) { return {log1p_lane(a.from), log1p_lane(a.by / (1 + a.from))}; }
IRSIG_LANE Step sqrt_step(Step a) {
  const double from = std::sqrt(a.from), sum = from + std::sqrt(a.from + a.by);
  const bool positive = sum > 0;
  return {from, positive ? a.by / (positive ? sum : 1.0) : 0.0};
}

// depth / X, of X > 0
IRSIG_LANE Step fraction_of_weak_depth(Step x, Step lorentz, Step doppler) {
  const Step yc = x / (4 * lorentz + x);
  const Step z = x / (1.7 * doppler);
  Step s = z * z;
  // Below, s has no digits left, and nothing depends on it.
  s.from = s.from > 1e-300 ? s.from : 1e-300;
  const Step yd = constant(1) - log1p_step(s) / s;
  const Step ratio = yd / yc;
  // Y^(-1/2), the two deficits joined
  const Step joined = yd / sqrt_step(constant(1) - yd * yd + ratio * ratio);
  return sqrt_step(constant(1) - joined);
}

IRSIG_LANE double sum_of(const double (&lane)[kGasLanes]) {
  return ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
}

}  // namespace

IRSIG_CLONES void grow(std::size_t bands, const GrowthSums& sums, const double* weak,
                       const double* lorentz, const double* doppler, const Steps& through) {
  double *sum_weak = sums.weak, *sum_lorentz = sums.lorentz, *sum_doppler = sums.doppler,
         *depth = sums.depth, *from = through.from, *by = through.by;
#pragma GCC ivdep
  for (std::size_t i = 0; i < bands; ++i) {
    // Less has lost digits to underflow, and is nobody's light.
    const bool some = weak[i] > 1e-280;
    const bool first = !(sum_weak[i] > 0);
    const double w = some ? weak[i] : 1.0, lw = lorentz[i] * w, dw = doppler[i] * w;
    const Step x{first ? w : sum_weak[i], first ? 0.0 : w};
    const Step l{first ? lw : sum_lorentz[i], first ? 0.0 : lw};
    const Step d{first ? dw : sum_doppler[i], first ? 0.0 : dw};
    const Step whole = x * fraction_of_weak_depth(x, l / x, d / x);
    const double grown = some ? (first ? whole.from : whole.by) : 0.0;
    const double before = exp_lane(-depth[i]);
    from[i] = before;
    by[i] = before * expm1_lane(-grown).exp_minus_1;
    depth[i] += grown;
    sum_weak[i] += some ? w : 0.0;
    sum_lorentz[i] += some ? lw : 0.0;
    sum_doppler[i] += some ? dw : 0.0;
  }
}

IRSIG_CLONES void line_decay(std::size_t points, const std::int32_t* thousandth_ln,
                             const HotLinePlace& place, double amount_mol_m2, double* decay) {
  const std::int32_t* row[8];
  double weight[8];
  for (std::size_t r = 0; r < 8; ++r) {
    row[r] = thousandth_ln + place.row[r] * points;
    weight[r] = place.weight[r];
  }
#pragma GCC ivdep
  for (std::size_t n = 0; n < points; ++n) {
    double ln = 0;
    for (std::size_t r = 0; r < 8; ++r) ln += weight[r] * row[r][n];
    const ExpLane e = expm1_lane(-amount_mol_m2 * exp_lane(1e-3 * ln));
    decay[n] = e.exp_minus_1 > -0.5 ? e.exp_minus_1 : e.exp;
  }
}

IRSIG_CLONES LineStep through_lines(std::size_t points, const double* decay, double* left) {
  double from[kGasLanes] = {}, by[kGasLanes] = {};
  for (std::size_t n = 0; n < points; n += kGasLanes) {
#pragma GCC ivdep
#pragma GCC unroll 1
    for (std::size_t j = 0; j < kGasLanes; ++j) {
      const double stored = decay[n + j], light = left[n + j];
      const bool thin = stored <= 0;
      from[j] += light;
      by[j] += light * (thin ? stored : stored - 1.0);
      left[n + j] = light * (thin ? 1.0 + stored : stored);
    }
  }
  return {sum_of(from), sum_of(by)};
}

IRSIG_CLONES void multiply(std::size_t bands, const Steps& step, const Steps& factor) {
  double *from = step.from, *by = step.by;
  const double *f = factor.from, *change = factor.by;
#pragma GCC ivdep
  for (std::size_t i = 0; i < bands; ++i) {
    by[i] = by[i] * (f[i] + change[i]) + from[i] * change[i];
    from[i] *= f[i];
  }
}

IRSIG_CLONES void soot_step(std::size_t bands, double volume_fraction_m, const double* per_m,
                            double* depth, const Steps& through) {
  double *from = through.from, *by = through.by;
#pragma GCC ivdep
  for (std::size_t i = 0; i < bands; ++i) {
    const double d = per_m[i] * volume_fraction_m, before = exp_lane(-depth[i]);
    from[i] = before;
    by[i] = before * expm1_lane(-d).exp_minus_1;
    depth[i] += d;
  }
}

IRSIG_CLONES void planck_mean(std::size_t bands, const double* lambda_um, const double* scale,
                              double t1, double t2, double* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < bands; ++i) {
    const double a = expm1_lane(kC2UmK / (lambda_um[i] * t1)).exp_minus_1,
                 b = expm1_lane(kC2UmK / (lambda_um[i] * t2)).exp_minus_1;
    out[i] = 0.5 * (scale[i] / a + scale[i] / b);
  }
}

IRSIG_CLONES WaterTaken through_water(std::size_t points, const WaterPoints& point,
                                      const double* low, const double* high, double weight_high,
                                      double weak_depth, double* left) {
  double below[kMostWaterPoints + 1];  // share of the absorption that lies below a point's end
  below[0] = 0;
#pragma GCC ivdep
  for (std::size_t n = 0; n < points; ++n) {
    const std::int32_t j = point.place[n];
    const double v = point.on[n];
    const double a = (1 - v) * low[j] + v * low[j + 1], b = (1 - v) * high[j] + v * high[j + 1];
    below[n + 1] = (1 - weight_high) * a + weight_high * b;
  }
  double through[kGasLanes] = {}, all[kGasLanes] = {};
  for (std::size_t n = 0; n < points; n += kGasLanes) {
#pragma GCC ivdep
    for (std::size_t j = 0; j < kGasLanes; ++j) {
      const double depth =
          weak_depth * (below[n + j + 1] - below[n + j]) * point.inverse_weight[n + j];
      const ExpLane e = expm1_lane(-depth);
      const double taken = -left[n + j] * e.exp_minus_1;
      through[j] += taken * point.air[n + j];
      all[j] += taken;
      left[n + j] *= e.exp;
    }
  }
  return {sum_of(through), sum_of(all)};
}

IRSIG_CLONES void add_hot_bands(const HotLevels& levels, double temperature_k,
                                const double* wavenumber_cm1, const double* scale,
                                HotBandSums& sums) {
  double sum_weak[kGasLanes], sum_strong[kGasLanes];
  for (std::size_t j = 0; j < kGasLanes; ++j) {
    sum_weak[j] = sums.weak[j];
    sum_strong[j] = sums.strong[j];
  }
  constexpr double kB = kCo2RotationCm1, kA = kCo2RotationChangeCm1;
  for (std::size_t v = 0; v < HotLevels::kV; ++v) {
    const double states = v % 2 == 1 ? 0.25 * static_cast<double>((v + 1) * (v + 3))
                                     : 0.25 * static_cast<double>((v + 2) * (v + 2));
    const double root = std::sqrt(0.5 * states);
    double alive[kGasLanes];
    for (double& a : alive) a = 1;
    for (std::size_t v3 = 0; v3 < HotLevels::kV3; ++v3) {
      const double gamma = kB - kA * static_cast<double>(v3 + 1);
      const double rate = kRadcalC2CmK * gamma / (kA * kA * temperature_k);
      const double centre = levels.centre_cm1[v][v3], filled = levels.filled[v][v3];
#pragma GCC ivdep
      for (std::size_t j = 0; j < kGasLanes; ++j) {
        const double delta = kA * (wavenumber_cm1[j] - centre);
        const double square = gamma * gamma - delta;
        const double d = 2 * std::sqrt(square > 0 ? square : 1.0);
        const double f1 = gamma - 0.5 * d, f2 = gamma + 0.5 * d;
        const double head = rate * delta * (1 + 0.5 * kA / gamma);
        const double tail = rate * 2 * gamma * f1;
        const double meant = ((square > 0) & (head > -78) & (tail < 78)) ? alive[j] : 0.0;
        const double common = scale[j] * filled;
        const double minus = common * std::abs(f1) * exp_lane(head - tail);
        const double plus = common * std::abs(f2) * exp_lane(head - rate * 2 * gamma * f2);
        const double added = meant > 0 ? (minus + plus) / d : 0.0;
        const double weak = sum_weak[j] + added;
        const double strong = root * (std::sqrt(minus) + std::sqrt(plus)) / d;
        const double stays = ((added >= 1e-4 * weak) & (weak > 0)) ? meant : 0.0;
        sum_weak[j] = weak;
        sum_strong[j] += stays > 0 ? strong : 0.0;
        alive[j] = stays;
      }
      if (!(sum_of(alive) > 0)) break;
    }
  }
  for (std::size_t j = 0; j < kGasLanes; ++j) {
    sums.weak[j] = sum_weak[j];
    sums.strong[j] = sum_strong[j];
  }
}

IRSIG_CLONES void exp_of(std::size_t n, const double* x, double* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) out[i] = exp_lane(x[i]);
}

}  // namespace irsig
