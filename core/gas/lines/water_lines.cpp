#include "core/gas/lines/water_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/gas/lines/water_levels.h"

namespace irsig {
namespace {

constexpr double kFirstCm1 = 30, kLastCm1 = 7200;
constexpr double kHdoFraction = 3.107e-4;
// HDO counts where it is cool, and needs less.
struct Limits {
  double basis_cm1, highest_cm1, highest_lower_cm1;
  std::size_t most_j;
};
constexpr Limits kH2oLimits = {22000, 16000, 12500, 36}, kHdoLimits = {15000, 11000, 7000, 30};
// 8 pi^3 / 3 h c, of squared moments in debye^2.                                     [cm]
constexpr double kStrengthPerDebye2 = 4.162034e-19;
// Transitions weaker than this at all of these temperatures are left out.
constexpr double kWeakest = 1e-28;
constexpr std::array<double, 5> kAtK = {300, 600, 1000, 1700, 3000};

struct Transition {
  double centre_cm1;
  float lower_cm1;
  float strength;  // over the Boltzmann factors and the partition sum
  std::uint8_t j;
};

struct Kind {
  double fraction;
  Limits limits;
  std::vector<Transition> transition;
  // Levels, as many times as they count, and the rest of the basis with first-order energies.
  std::vector<std::pair<double, double>> level;
  [[nodiscard]] double partition_sum(double t) const {
    double sum = 0;
    for (const auto& [energy, states] : level) sum += states * std::exp(-kC2CmK * energy / t);
    return sum;
  }
};

void add_levels(const WaterLevels& of, std::vector<std::pair<double, double>>& out) {
  for (const double e : of.energy_cm1)
    out.emplace_back(e, of.nuclear_weight * static_cast<double>(2 * of.j + 1));
}

// Adds the levels above the computed ones, from the energies of the basis and their own rotation.
void add_rest(const WaterBasis& basis, std::size_t j, double highest_cm1,
              std::vector<std::pair<double, double>>& out) {
  const auto jj = static_cast<double>(j * (j + 1));
  const double weight = basis.symmetries() == 2 ? 2 : 1;  // mean of 1 and 3
  for (std::size_t k = 0; k <= j; ++k)
    for (std::size_t s = 0; s < basis.symmetries(); ++s) {
      const WaterBasis::States& states = basis.states(k, s);
      const std::size_t count = states.energy_cm1.size();
      for (std::size_t n = 0; n < count; ++n) {
        const double e = states.energy_cm1[n] +
                         (jj - static_cast<double>(k * (k + 1))) * states.along[n * (count + 1)];
        if (e > highest_cm1)
          out.emplace_back(e, weight * (k == 0 ? 1 : 2) * static_cast<double>(2 * j + 1));
      }
    }
}

class Finder {
 public:
  explicit Finder(Kind& kind) : kind_(kind) {
    for (std::size_t i = 0; i < kAtK.size(); ++i) at_[i] = kC2CmK / kAtK[i];
  }
  void set_sums(const std::array<double, kAtK.size()>& sums) { sums_ = sums; }

  void add(const WaterBasis& basis, const WaterLevels& from, const WaterLevels& to) {
    const std::vector<double> moment = water_moments(basis, from, to);
    if (moment.empty()) return;
    const std::size_t n = from.energy_cm1.size();
    for (std::size_t i = 0; i < to.energy_cm1.size(); ++i)
      for (std::size_t k = 0; k < n; ++k) {
        const double up = to.energy_cm1[i], down = from.energy_cm1[k], nu = std::abs(up - down);
        const double lower = std::min(up, down);
        if (nu < kFirstCm1 || nu > kLastCm1 || lower > kind_.limits.highest_lower_cm1) continue;
        const double strength =
            kStrengthPerDebye2 * nu * from.nuclear_weight * moment[i * n + k] * kind_.fraction;
        if (strength < kWeakest) continue;
        bool counts = false;
        for (std::size_t t = 0; t < kAtK.size() && !counts; ++t)
          counts = strength * std::exp(-at_[t] * lower) > kWeakest * sums_[t];
        if (counts)
          kind_.transition.push_back({nu, static_cast<float>(lower), static_cast<float>(strength),
                                      static_cast<std::uint8_t>(from.j)});
      }
  }

 private:
  Kind& kind_;
  std::array<double, kAtK.size()> at_{}, sums_{};
};

Kind compute(WaterKind of, double fraction, const Limits& limits) {
  Kind out{fraction, limits, {}, {}};
  const WaterBasis basis({of, limits.basis_cm1, limits.most_j});
  std::vector<std::vector<WaterLevels>> levels;
  for (std::size_t j = 0; j <= limits.most_j; ++j) {
    auto& here = levels.emplace_back();
    for (std::size_t p = 0; p < 2; ++p)
      for (std::size_t s = 0; s < basis.symmetries(); ++s) {
        here.push_back(water_levels(basis, j, p, s, limits.highest_cm1));
        add_levels(here.back(), out.level);
      }
    add_rest(basis, j, limits.highest_cm1, out.level);
  }
  Finder finder(out);
  std::array<double, kAtK.size()> sums{};
  for (std::size_t t = 0; t < kAtK.size(); ++t) sums[t] = out.partition_sum(kAtK[t]);
  finder.set_sums(sums);
  const std::size_t count = basis.symmetries();
  for (std::size_t j = 0; j <= limits.most_j; ++j)
    for (std::size_t s = 0; s < count; ++s) {
      finder.add(basis, levels[j][s], levels[j][count + basis.other(s)]);
      if (j == 0) continue;
      for (std::size_t p = 0; p < 2; ++p)
        finder.add(basis, levels[j - 1][p * count + s], levels[j][p * count + basis.other(s)]);
    }
  return out;
}

const std::array<Kind, 2>& kinds() {
  static const std::array<Kind, 2> all = {compute(WaterKind::kH2o, 1 - kHdoFraction, kH2oLimits),
                                          compute(WaterKind::kHdo, kHdoFraction, kHdoLimits)};
  return all;
}

// In air, at the temperature.
double water_line_width(int j, double temperature_k) {
  const double at_296_k = 0.02 + 0.08 * std::exp(-std::pow(j / 11.0, 1.5));
  const double exponent = 0.35 + 0.4 * std::exp(-std::pow(j / 10.0, 2.0));
  return at_296_k * std::pow(296 / temperature_k, exponent);
}

}  // namespace

double water_partition_sum(double temperature_k) { return kinds()[0].partition_sum(temperature_k); }

std::vector<SpectralLine> water_lines(double temperature_k, double weakest) {
  std::vector<SpectralLine> out;
  for (const Kind& kind : kinds()) {
    const double per_state = 1 / kind.partition_sum(temperature_k);
    for (const Transition& t : kind.transition) {
      const double s = per_state * t.strength * std::exp(-kC2CmK * t.lower_cm1 / temperature_k) *
                       (1 - std::exp(-kC2CmK * t.centre_cm1 / temperature_k));
      if (s >= weakest) out.push_back({t.centre_cm1, s, water_line_width(t.j, temperature_k)});
    }
  }
  return out;
}

}  // namespace irsig
