#include "core/gas/lines/co2_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/gas/lines/polyad.h"

namespace irsig {
namespace {

constexpr int kQuanta = 20, kV3 = 7, kJ = 200;
constexpr double kHighestCm1 = 16000;
constexpr double kFundamentalStrength = 9.13e-17, kCo2ReferenceK = 296;
// Square of the moment of the bending band over that of the fundamental: what makes the Planck mean
// at 300 K HITEMP2010's.
constexpr double kBend = 0.16;
// Moments of the weak bands at 1900-2150 cm-1 over that of the fundamental: v1 + 1 with v2 + 1, and
// v2 + 3; and by how much both change with m (the P branches are several times the R branches).
// Those that meet the band means of carbon dioxide at 1900-2140 cm-1, 250 and 296 K, of the cold
// air's table best.
constexpr double kMoreV1V2 = 4.78e-3, kThreeV2 = 1.89e-3, kHermanWallis = -0.0464;
// Moments of v3 + 1 with v1 - 1 and with v2 - 2 over that of the fundamental: those that give
// (00011)-(10001) 7.1e-22 and (00011)-(10002) 1.00e-21 cm per molecule at 296 K, as the cold air's
// table has them. (A second solution has them the other way round; the first is what the cubic
// constant of v1 and v3 does.)
constexpr double kLessV1 = 0.16924, kLessV2 = 0.01762;

// Air's widths fall from 0.095 to 0.06 cm-1/atm with m, as measured.       [rothman1981]
double width(int m) { return 0.058 + 0.037 * std::exp(-m / 25.0); }

double vibrational_sum(const Co2Isotopologue& of, double t) {
  struct Level {
    double energy_cm1, states;
  };
  static std::map<double, std::vector<Level>> known;  // by abundance, which names the isotopologue
  std::vector<Level>& level = known[of.abundance];
  if (level.empty()) {
    for (int quanta = 0; quanta <= 2 * kQuanta; ++quanta) {
      for (int l = quanta % 2; l <= quanta; l += 2) {
        for (int v3 = 0; v3 <= 8; ++v3) {
          for (const double e : co2_polyad(of, quanta, l, v3, l, false).energy_cm1) {
            const double b = 0.390219 * of.rotation * l;  // l (l + 1) - l^2 of the lowest J
            if (e - b < 2 * kHighestCm1) level.push_back({e - b, l == 0 ? 1.0 : 2.0});
          }
        }
      }
    }
  }
  double sum = 0;
  for (const Level& l : level) sum += l.states * std::exp(-kC2CmK * l.energy_cm1 / t);
  return sum;
}

class Lister {
 public:
  Lister(const Co2Isotopologue& of, Co2Region region, double t, double weakest)
      : of_(of),
        region_(region),
        first_cm1_(region == Co2Region::k15um   ? 460
                   : region == Co2Region::k10um ? 800
                                                : 1900),
        last_cm1_(region == Co2Region::k15um   ? 920
                  : region == Co2Region::k10um ? 1130
                                               : 2480),
        t_(t),
        weakest_(weakest) {
    const double b = 0.390219 * of.rotation;
    // The rotational sum with its first corrections: quantum and centrifugal.
    const double rotational =
        t / (kC2CmK * b) + 1.0 / 3 + 2 * 1.3334e-7 * t / (kC2CmK * b * b) * t / (kC2CmK * b);
    per_state_ = of.abundance * (of.symmetric ? 2 : 1) / (vibrational_sum(of, t) * rotational);
  }

  // Levels of one polyad and J; empty if nuclear spin forbids them or they lie too high.
  const Polyad& levels(int quanta, int l, int v3, int j, bool upper) {
    const auto key = std::tuple(quanta, l, v3, j, upper);
    const auto [it, isnew] = known_.try_emplace(key);
    if (isnew && exists(l, v3, j, upper)) it->second = co2_polyad(of_, quanta, l, v3, j, upper);
    return it->second;
  }

  void list(std::vector<SpectralLine>& out, double strength_scale) {
    for (int quanta = 0; quanta <= kQuanta; ++quanta) {
      for (int l = quanta % 2; l <= quanta; l += 2) {
        for (int v3 = 0; v3 <= kV3; ++v3) {
          // Higher levels are too empty for any line that is asked for.
          const double highest = std::min(
              kHighestCm1, t_ / kC2CmK * std::log(strength_scale * per_state_ * 1e4 / weakest_));
          if (co2_polyad(of_, quanta, l, v3, l, false).energy_cm1.front() > highest) break;
          for (int j = l; j < kJ; ++j) {
            if (j > l && co2_polyad(of_, quanta, l, v3, j, false).energy_cm1.front() > highest)
              break;
            for (const bool upper : {false, true}) {
              if (l == 0 && upper) continue;
              from(out, strength_scale, quanta, l, v3, j, upper);
            }
          }
        }
      }
    }
  }

 private:
  // The pair's lower level has e symmetry. Molecules with two equal nuclei of spin 0 have those
  // levels alone that are even under their exchange: e with j + l + v3 even, f with it odd.
  [[nodiscard]] bool exists(int l, int v3, int j, bool upper) const {
    return !of_.symmetric || (j + l + v3 + (upper ? 1 : 0)) % 2 == 0;
  }

  void from(std::vector<SpectralLine>& out, double scale, int quanta, int l, int v3, int j,
            bool upper) {
    const Polyad low = levels(quanta, l, v3, j, upper);
    if (low.energy_cm1.empty()) return;
    const double ll = l;
    if (region_ == Co2Region::k15um) {
      bend(out, scale * kBend, 1, quanta, l, v3, j, upper, low,
           [](const Bend& of, const Amplitudes& a, const Amplitudes& b) {
             double sum = 0;
             for (std::size_t v1 = 0; v1 < a.size(); ++v1)
               sum += a[v1] * b[v1] * std::sqrt(of.along(v1) + 1);
             return sum;
           });
      return;
    }
    if (region_ == Co2Region::k10um) {
      if (quanta - l < 2) return;
      stretch(out, scale, quanta - 2, l, v3, j, upper, low,
              [&](const std::vector<double>& a, const std::vector<double>& b) {
                double sum = 0;
                for (std::size_t v1 = 0; v1 < a.size(); ++v1) {
                  const double n = static_cast<double>(v1), v2 = quanta - 2 * n;
                  if (v1 > 0) sum += kLessV1 * std::sqrt(n) * a[v1] * b[v1 - 1];
                  if (v1 < b.size())
                    sum += kLessV2 * 0.5 * std::sqrt(v2 * v2 - ll * ll) * a[v1] * b[v1];
                }
                return sum * sum;
              });
      return;
    }
    stretch(out, scale, quanta, l, v3, j, upper, low,
            [](const std::vector<double>& a, const std::vector<double>& b) {
              double sum = 0;
              for (std::size_t v1 = 0; v1 < a.size(); ++v1) sum += a[v1] * b[v1];
              return sum * sum;
            });
    bend(out, scale, 3, quanta, l, v3, j, upper, low,
         [](const Bend& of, const Amplitudes& a, const Amplitudes& b) {
           double sum = 0;
           for (std::size_t v1 = 0; v1 < a.size(); ++v1) {
             const double up = of.along(v1) + 1;
             sum += kThreeV2 * a[v1] * b[v1] * std::sqrt(up * (up + 1) * (of.against(v1) + 1));
             if (v1 + 1 < b.size())
               sum += kMoreV1V2 * a[v1] * b[v1 + 1] * std::sqrt(static_cast<double>(v1 + 1) * up);
           }
           return sum * (1 + kHermanWallis * of.m);
         });
  }

  // v3 to v3 + 1 and the polyad of `to`: P and R keep the symmetry; Q is weak and changes it.
  template <typename Moment>
  void stretch(std::vector<SpectralLine>& out, double scale, int to, int l, int v3, int j,
               bool upper, const Polyad& low, const Moment& moment) {
    const double jj = j, ll = l;
    for (const int dj : {-1, 0, 1}) {
      if (j + dj < l || (dj == 0 && l == 0)) continue;
      const double factor = dj == 1   ? ((jj + 1) * (jj + 1) - ll * ll) / (jj + 1)
                            : dj == 0 ? (2 * jj + 1) * ll * ll / (jj * (jj + 1))
                                      : (jj * jj - ll * ll) / jj;
      const Polyad& high = levels(to, l, v3 + 1, j + dj, dj == 0 ? !upper : upper);
      add(out, scale * (v3 + 1) * factor, low, high, dj, j, moment);
    }
  }

  // A change of l by one: the quanta of the bend that turn with it and against it, in the lower
  // state with that v1.
  struct Bend {
    double quanta, k, m;  // 2 v1 + v2; l, or -l where l falls; J + 1, 0, -J
    [[nodiscard]] double along(std::size_t v1) const { return 0.5 * (v2(v1) + k); }
    [[nodiscard]] double against(std::size_t v1) const { return 0.5 * (v2(v1) - k); }
    [[nodiscard]] double v2(std::size_t v1) const { return quanta - 2 * static_cast<double>(v1); }
  };
  using Amplitudes = std::vector<double>;

  // l to l +- 1, to the polyad with `more` quanta; `moment` is not yet squared.
  template <typename Moment>
  void bend(std::vector<SpectralLine>& out, double scale, int more, int quanta, int l, int v3,
            int j, bool upper, const Polyad& low, const Moment& moment) {
    const double jj = j;
    for (const int dl : {-1, 1}) {
      if (l + dl < 0) continue;
      const double k = dl * l;
      // A level without a pair is reached from, and reaches, both of l = +1 and -1.
      const double ways = l == 0 || l + dl == 0 ? 2 : 1;
      for (const int dj : {-1, 0, 1}) {
        if (j + dj < l + dl || (j == 0 && dj < 1)) continue;
        const double factor = dj == 1 ? (jj + 2 + k) * (jj + 1 + k) / (2 * (jj + 1))
                              : dj == 0
                                  ? (jj + 1 + k) * (jj - k) * (2 * jj + 1) / (2 * jj * (jj + 1))
                                  : (jj - 1 - k) * (jj - k) / (2 * jj);
        const bool to_upper = dj == 0 ? !upper : upper;
        if (l + dl == 0 && to_upper) continue;
        const Polyad& high = levels(quanta + more, l + dl, v3, j + dj, to_upper);
        const Bend of{static_cast<double>(quanta), k, dj == 1 ? jj + 1 : dj == 0 ? 0 : -jj};
        add(out, scale * factor * ways, low, high, dj, j,
            [&](const Amplitudes& a, const Amplitudes& b) {
              const double sum = moment(of, a, b);
              return sum * sum;
            });
      }
    }
  }

  template <typename Moment>
  void add(std::vector<SpectralLine>& out, double scale, const Polyad& low, const Polyad& high,
           int dj, int j, const Moment& moment) {
    for (std::size_t a = 0; a < low.energy_cm1.size(); ++a) {
      const double e = low.energy_cm1[a];
      const double filled = scale * per_state_ * std::exp(-kC2CmK * e / t_);
      if (filled < weakest_ || e > kHighestCm1) continue;
      for (std::size_t b = 0; b < high.energy_cm1.size(); ++b) {
        const double nu = high.energy_cm1[b] - e;
        if (nu < first_cm1_ || nu > last_cm1_) continue;
        const double s = filled * nu / 2349.143 * (1 - std::exp(-kC2CmK * nu / t_)) *
                         moment(low.amplitude[a], high.amplitude[b]);
        if (s < weakest_) continue;
        out.push_back({nu, s, width(dj == 1 ? j + 1 : j)});
      }
    }
  }

  Co2Isotopologue of_;
  Co2Region region_;
  double first_cm1_, last_cm1_;
  double t_, weakest_, per_state_;
  std::map<std::tuple<int, int, int, int, bool>, Polyad> known_;
};

// Returns the factor that makes the fundamental's strength the known one.
double strength_scale() {
  static const double scale = [] {
    const Co2Isotopologue& of = kCo2Isotopologues[0];
    const double b = 0.390219;
    const double per_state =
        of.abundance * 2 /
        (vibrational_sum(of, kCo2ReferenceK) * (kCo2ReferenceK / (kC2CmK * b) + 1.0 / 3));
    double sum = 0;
    for (int j = 0; j < kJ; j += 2) {
      const double e = b * j * (j + 1) - 1.3334e-7 * std::pow(j * (j + 1), 2);
      sum += (2 * j + 1) * std::exp(-kC2CmK * e / kCo2ReferenceK);
    }
    return kFundamentalStrength / (sum * per_state);
  }();
  return scale;
}

}  // namespace

std::vector<SpectralLine> co2_lines(Co2Region region, double temperature_k, double weakest) {
  std::vector<SpectralLine> out;
  for (const Co2Isotopologue& of : kCo2Isotopologues) {
    Lister(of, region, temperature_k, weakest).list(out, strength_scale());
  }
  return out;
}

}  // namespace irsig
