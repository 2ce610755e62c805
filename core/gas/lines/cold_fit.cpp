#include "core/gas/lines/cold_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace irsig {
namespace {

double parabola(const ColdFit& fit, double temperature_k, double reference_k) {
  const double x = temperature_k / reference_k - 1;
  return 1 + x * (fit.b + x * fit.c);
}

bool positive(const ColdFit& fit, double reference_k) {
  for (double t = 170; t <= 330; t += 10) {
    if (parabola(fit, t, reference_k) < 0.01) return false;
  }
  return true;
}

double misfit(const ColdFit& fit, const std::vector<double>& k, const std::vector<double>& weight,
              double reference_k, const std::vector<BandSample>& samples) {
  if (!positive(fit, reference_k)) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const BandSample& s : samples) {
    const double warm = parabola(fit, s.temperature_k, reference_k),
                 thin = std::pow(s.pressure_atm, fit.a);
    for (std::size_t n = 0; n < s.amount.size(); ++n) {
      double t = 0;
      for (std::size_t i = 0; i < weight.size(); ++i) {
        t += weight[i] *
             std::exp(-k[i] * (fit.alpha[i] * thin + 1 - fit.alpha[i]) * warm * s.amount[n]);
      }
      const double off = (t - s.transmittance[n]) / (s.transmittance[n] + 0.1);
      sum += s.importance * off * off;
    }
  }
  return sum;
}

// The parabola that gives the samples at 1 atm their mean change of absorption where depths are
// near 1.
void begin_with_temperature(ColdFit& fit, const std::vector<double>& k,
                            const std::vector<double>& weight, double reference_k,
                            const std::vector<BandSample>& samples) {
  double xx = 0, xxx = 0, xxxx = 0, xy = 0, xxy = 0;
  for (const BandSample& s : samples) {
    if (s.pressure_atm != 1) continue;
    // The factor on all amounts that gives the transmittance nearest to 0.5.
    std::size_t n = 0;
    for (std::size_t i = 0; i < s.amount.size(); ++i) {
      if (std::abs(s.transmittance[i] - 0.5) < std::abs(s.transmittance[n] - 0.5)) n = i;
    }
    double low = 1e-3, high = 1e3;
    for (int i = 0; i < 60; ++i) {
      const double middle = std::sqrt(low * high);
      double t = 0;
      for (std::size_t j = 0; j < k.size(); ++j)
        t += weight[j] * std::exp(-k[j] * middle * s.amount[n]);
      (t > s.transmittance[n] ? low : high) = middle;
    }
    const double x = s.temperature_k / reference_k - 1, y = low - 1;
    xx += x * x;
    xxx += x * x * x;
    xxxx += x * x * x * x;
    xy += x * y;
    xxy += x * x * y;
  }
  fit.b = (xy * xxxx - xxy * xxx) / (xx * xxxx - xxx * xxx);
  fit.c = (xxy * xx - xy * xxx) / (xx * xxxx - xxx * xxx);
  // A parabola that would fall below 0 in the cold is lifted there.
  while (!positive(fit, reference_k)) fit.c += 0.1;
}

// The share of each term that grows as p^a, from how its absorption changes with pressure.
void set_alpha(ColdFit& fit, const std::vector<TermSample>& by_pressure) {
  for (std::size_t i = 0; i < fit.alpha.size(); ++i) {
    double above = 0, below = 0;
    for (const TermSample& s : by_pressure) {
      const double less = 1 - std::pow(s.pressure_atm, fit.a);
      above += s.importance * less * (1 - s.ratio[i]);
      below += s.importance * less * less;
    }
    fit.alpha[i] = std::clamp(above / below, 0.0, 1.0);
  }
}

}  // namespace

ColdFit fit_cold_band(const std::vector<double>& k, const std::vector<double>& weight,
                      double reference_k, const std::vector<TermSample>& by_pressure,
                      const std::vector<BandSample>& samples) {
  ColdFit best;
  double least = std::numeric_limits<double>::infinity();
  for (double a = 1; a > 0.25; a -= 0.025) {
    ColdFit fit;
    fit.alpha.resize(k.size());
    fit.a = a;
    set_alpha(fit, by_pressure);
    begin_with_temperature(fit, k, weight, reference_k, samples);
    double now = misfit(fit, k, weight, reference_k, samples);
    for (double step = 0.2; step > 0.002;) {
      const double before = now;
      const auto try_step = [&](double& parameter, double by) {
        const double old = parameter;
        for (const double sign : {1.0, -1.0}) {
          parameter = old + sign * by;
          const double then = misfit(fit, k, weight, reference_k, samples);
          if (then < now) {
            now = then;
            return;
          }
        }
        parameter = old;
      };
      try_step(fit.b, step);
      try_step(fit.c, 4 * step);
      if (now > 0.995 * before) step /= 2;
    }
    if (now < least) {
      least = now;
      best = fit;
    }
  }
  return best;
}

}  // namespace irsig
