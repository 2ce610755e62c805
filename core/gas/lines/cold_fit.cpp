#include "core/gas/lines/cold_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace irsig {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

bool positive(const AirScaling& scaling, double reference_k) {
  for (double t = 170; t <= 330; t += 10) {
    if (scaling.at(1, t / reference_k - 1) < 0.01) return false;
  }
  return true;
}

class BandFit {
 public:
  BandFit(const std::vector<double>& k, const std::vector<double>& weight, double reference_k,
          const std::array<std::vector<double>, kThroughColdAir>& hot_fraction,
          const std::vector<ColdState>& states)
      : k_(k),
        weight_(weight),
        reference_k_(reference_k),
        hot_share_(hot_fraction),
        states_(states) {}

  // Parameter by parameter, in steps that halve, from several beginnings.
  ColdFit best() const {
    const AirScaling warm = beginning();
    ColdFit best;
    double least = kInfinite;
    for (const double a : {1.0, 0.8, 0.6}) {
      for (const double other_a : {0.0, 0.3}) {
        for (const double apart : {0.0, 2.0}) {
          ColdFit fit{{}, {a, warm.b - apart, warm.c}, {other_a, warm.b + apart, warm.c}};
          const double now = descend(fit);
          if (now >= least) continue;
          least = now;
          best = fit;
        }
      }
    }
    return best;
  }

 private:
  double descend(ColdFit& fit) const {
    double now = misfit(fit);
    for (double step = 1; step > 0.02;) {
      const double before = now;
      for (AirScaling* scaling : {&fit.first, &fit.second}) {
        for (const auto& [parameter, unit] :
             {std::pair{&scaling->a, 0.1}, {&scaling->b, 0.5}, {&scaling->c, 2.0}}) {
          const double old = *parameter;
          for (const double sign : {1.0, -1.0}) {
            *parameter = old + sign * step * unit;
            const double then = misfit(fit);
            if (then < now) {
              now = then;
              break;
            }
            *parameter = old;
          }
        }
      }
      if (!(now <= 0.995 * before)) step /= 2;
    }
    misfit(fit);  // its shares
    return now;
  }

  // And sets the shares.
  double misfit(ColdFit& fit) const {
    if (!positive(fit.first, reference_k_) || !positive(fit.second, reference_k_)) return kInfinite;
    std::vector<double> first, second;
    for (const ColdState& s : states_) {
      const double x = s.temperature_k / reference_k_ - 1;
      first.push_back(fit.first.at(s.pressure_atm, x));
      second.push_back(fit.second.at(s.pressure_atm, x));
    }
    double sum = 0;
    fit.share.assign(k_.size(), 0.0);
    for (std::size_t i = 0; i < k_.size(); ++i) {
      double above = 0, below = 0;
      for (std::size_t j = 0; j < states_.size(); ++j) {
        const ColdState& s = states_[j];
        const double apart = (first[j] - second[j]) / s.ratio[i];
        above += s.importance * apart * (1 - second[j] / s.ratio[i]);
        below += s.importance * apart * apart;
      }
      const double share = fit.share[i] = below > 0 ? std::clamp(above / below, 0.0, 1.0) : 0;
      for (std::size_t j = 0; j < states_.size(); ++j) {
        const double off = (share * first[j] + (1 - share) * second[j]) / states_[j].ratio[i] - 1;
        sum += 0.02 * states_[j].importance * off * off;
      }
    }
    std::vector<double> absorption(k_.size());
    for (std::size_t j = 0; j < states_.size(); ++j) {
      for (std::size_t i = 0; i < k_.size(); ++i) {
        absorption[i] = k_[i] * (fit.share[i] * first[j] + (1 - fit.share[i]) * second[j]);
      }
      sum += states_[j].importance * misfit_of_state(states_[j], absorption);
    }
    return sum;
  }

  double misfit_of_state(const ColdState& s, const std::vector<double>& absorption) const {
    double sum = 0;
    for (std::size_t n = 0; n < s.amount.size(); ++n) {
      double through = 0;
      std::array<double, kThroughColdAir> hot{};
      for (std::size_t i = 0; i < absorption.size(); ++i) {
        const double passed = std::exp(-absorption[i] * s.amount[n]);
        through += weight_[i] * passed;
        for (std::size_t h = 0; h < hot.size(); ++h) hot[h] += hot_share_[h][i] * passed;
      }
      const auto add = [&](double ours, double exact, double least) {
        const double off = (ours - exact) / (exact + least);
        sum += off * off;
      };
      add(through, s.transmittance[n], 0.1);
      for (std::size_t h = 0; h < hot.size(); ++h) add(hot[h], s.hot_through[h][n], 0.02);
    }
    return sum;
  }

  // The parabola of the terms' mean change with temperature at 1 atm.
  AirScaling beginning() const {
    double xx = 0, xxx = 0, xxxx = 0, xy = 0, xxy = 0;
    for (const ColdState& s : states_) {
      if (s.pressure_atm != 1) continue;
      const double x = s.temperature_k / reference_k_ - 1;
      double y = 0;
      for (const double r : s.ratio) y += (r - 1) / static_cast<double>(s.ratio.size());
      xx += x * x;
      xxx += x * x * x;
      xxxx += x * x * x * x;
      xy += x * y;
      xxy += x * x * y;
    }
    AirScaling out;
    out.b = (xy * xxxx - xxy * xxx) / (xx * xxxx - xxx * xxx);
    out.c = (xxy * xx - xy * xxx) / (xx * xxxx - xxx * xxx);
    // One that would fall below 0 in the cold is lifted there, with room to be moved.
    while (!positive({0, out.b - 2, out.c}, reference_k_) ||
           !positive({0, out.b + 2, out.c}, reference_k_)) {
      out.c += 0.1;
    }
    return out;
  }

  const std::vector<double>&k_, &weight_;
  double reference_k_;
  const std::array<std::vector<double>, kThroughColdAir>& hot_share_;
  const std::vector<ColdState>& states_;
};

}  // namespace

double AirScaling::at(double pressure_atm, double x) const {
  return std::pow(pressure_atm, a) * (1 + x * (b + x * c));
}

ColdFit fit_cold_band(const std::vector<double>& k, const std::vector<double>& weight,
                      double reference_k,
                      const std::array<std::vector<double>, kThroughColdAir>& hot_fraction,
                      const std::vector<ColdState>& states) {
  return BandFit(k, weight, reference_k, hot_fraction, states).best();
}

}  // namespace irsig
