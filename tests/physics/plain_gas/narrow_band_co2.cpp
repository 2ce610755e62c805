#include <algorithm>
#include <array>
#include <cmath>

#include "core/gas/narrow_band_tables.h"
#include "tests/physics/plain_gas/co2_band.h"

namespace irsig::plain {
namespace {

// Fundamentals [cm-1]; the mean of the two lower ones counts for both.
constexpr double kOmega1 = 1354.91, kOmega2 = 673, kOmega3 = 2396.49;
constexpr double kOmega12 = 0.5 * (0.5 * kOmega1 + kOmega2);
constexpr double kB = 0.391635, kA = 0.0030875;  // rotation, and its change with v3 [cm-1]
constexpr double kLinesPerCm1 = 1 / (4 * kB);    // of a band without hot ones

// Bands that end on v3 + 1 from all levels below, each a P and an R branch of smeared-out lines.
//   strength      of the band at 300 K                                   [cm-2 atm-1]
//   combination   of its transition                                      [cm-1]
//   centre, bend  of level (v, v3): band centre; relative strength beside the harmonic v3 + 1
struct HotBands {
  double strength, combination;
  double (*centre)(int v, int v3);
  double (*bend)(int v);
};

double centre_4_3(int v, int v3) {
  constexpr double kX13 = -19.37, kX23 = -12.53, kX33 = -12.63;
  return kOmega3 + 0.5 * kX13 + kX23 + 2 * kX33 + 0.5 * (0.5 * kX13 + kX23) * v + 2 * kX33 * v3;
}
double centre_2_7_long(int v, int v3) {
  return v == 0 ? 3613 - 47.0 * v3 : 3598 - 18.0 * v - 47.0 * v3;
}
double centre_2_7_short(int v, int v3) {
  return v == 0 ? 3715 - 47.0 * v3 : 3728 - 5.0 * v - 47.0 * v3;
}
double bend_2_7(int v) { return v % 2 == 1 ? (v + 5) / 6.0 : (v + 3.0) * (v + 4) / (v + 2) / 6; }

struct Sums {
  double weak = 0, strong = 0;
};

void add(Sums& sums, const HotBands& bands, double nu, double t) {
  const auto share = [&](double energy, double temperature) {
    return 1 - std::exp(-kRadcalC2CmK * energy / temperature);
  };
  const auto filling = [&](double temperature) {
    return share(kOmega3, temperature) * std::pow(share(kOmega12, temperature), 3) *
           (2 - share(kOmega12, temperature)) * share(bands.combination, temperature);
  };
  const double scale = bands.strength * kB * kRadcalC2CmK / (kA * filling(kRadcalT0K)) *
                       share(nu, t) * filling(t) * nu * kRadcalT0K / (t * t);
  for (int v = 0; v < 20; ++v) {
    const double states = v % 2 == 1 ? 0.25 * (v + 1) * (v + 3) : 0.25 * (v + 2) * (v + 2);
    for (int v3 = 0; v3 < 10; ++v3) {
      const double gamma = kB - kA * (v3 + 1);
      const double centre = bands.centre(v, v3);
      const double delta = kA * (nu - centre);
      if (gamma * gamma <= delta) break;
      const double d = 2 * std::sqrt(gamma * gamma - delta);
      const double f1 = gamma - 0.5 * d, f2 = gamma + 0.5 * d;
      const double rate = kRadcalC2CmK * gamma / (kA * kA * t);
      const double head = rate * delta * (1 + 0.5 * kA / gamma);
      if (head <= -78 || rate * 2 * gamma * f1 >= 78) break;
      const double level = (v3 + 1) * states * bands.bend(v) *
                           std::exp(-(v3 * kOmega3 + v * kOmega12) * kRadcalC2CmK / t);
      const double common = scale * level / (centre * share(centre, t));
      const double minus = common * std::abs(f1) * std::exp(head - rate * 2 * gamma * f1);
      const double plus = common * std::abs(f2) * std::exp(head - rate * 2 * gamma * f2);
      const double added = (minus + plus) / d;
      sums.weak += added;
      if (!(added >= 1e-4 * sums.weak) || !(sums.weak > 0)) break;
      sums.strong += std::sqrt(0.5 * states) * (std::sqrt(minus) + std::sqrt(plus)) / d;
    }
  }
}

NarrowBand of(const Sums& sums, double t) {
  if (!(sums.weak > 0) || !(sums.strong > 0)) return {};
  return {sums.weak * t / 273, sums.strong * sums.strong / sums.weak};
}

// Bands whose lines only just overlap: strength [cm-2 atm-1] at t, centre.
struct PlainBand {
  double strength, centre;
};
template <std::size_t N>
NarrowBand of(const std::array<PlainBand, N>& bands, double nu, double t) {
  const double rate = kRadcalC2CmK / (4 * kB * t);
  double weak = 0;
  for (const PlainBand& b : bands) {
    const double x = nu - b.centre;
    weak += b.strength * rate * std::abs(x) * std::exp(-rate * x * x);
  }
  return {weak * t / 273, kLinesPerCm1};
}

NarrowBand band_2_0(double nu, double t) {
  // (000) to (041), (121), (201); strengths at 300 K.
  struct Band {
    double strength, centre;
    std::array<int, 3> quanta;
  };
  constexpr std::array<Band, 3> kBands = {
      {{0.272, 4860.5, {0, 4, 1}}, {1.01, 4983.5, {1, 2, 1}}, {0.426, 5109.0, {2, 0, 1}}}};
  constexpr std::array<double, 3> kOmega = {kOmega1, kOmega2, kOmega3};
  std::array<PlainBand, 3> bands{};
  for (std::size_t i = 0; i < 3; ++i) {
    double transition = 0, states = 1;
    for (std::size_t mode = 0; mode < 3; ++mode) {
      transition += kBands[i].quanta[mode] * kOmega[mode];
      states *= std::pow(1 - std::exp(-kRadcalC2CmK * kOmega[mode] / t), kBands[i].quanta[mode]);
    }
    bands[i] = {kBands[i].strength * kRadcalT0K / t *
                    (1 - std::exp(-kRadcalC2CmK * transition / t)) / states,
                kBands[i].centre};
  }
  return of(bands, nu, t);
}

NarrowBand band_10(double nu, double t) {
  constexpr double kLower = (kOmega1 + 2 * kOmega2) / 2;
  const auto strength = [&](double at_300_k) {
    return at_300_k * kRadcalT0K / t * std::exp(kRadcalC2CmK * kLower * (1 / kRadcalT0K - 1 / t)) *
           (1 - std::exp(-kRadcalC2CmK * (kOmega3 - kLower) / t)) /
           ((1 - std::exp(-kRadcalC2CmK * kOmega3 / t)) *
            (1 - std::exp(-kRadcalC2CmK * kLower / t)));
  };
  return of(std::array<PlainBand, 2>{{{strength(0.0219), 960.8}, {strength(0.0532), 1063.6}}}, nu,
            t);
}

NarrowBand band_15(double nu, double t) {
  const double strength = co2_15um_strengths().at(nu, t);
  if (!(strength > 0)) return {};
  // A parabola through 1.2, 8 and 30 lines per cm-1 at 300, 550 and 830 K.
  const double x = std::clamp(t, 300.0, 2400.0);
  const double lines = 1.2 * (x - 550) * (x - 830) / (250.0 * 530) -
                       8.0 * (x - 300) * (x - 830) / (250.0 * 280) +
                       30.0 * (x - 300) * (x - 550) / (530.0 * 280);
  return {strength, lines};
}

}  // namespace

NarrowBand co2_band(double nu, double t) {
  if (nu > 5725 || nu <= 500) return {};
  if (nu > 4550) return band_2_0(nu, t);
  if (nu > 3050 && nu <= 3800) {
    // (000)-(021) and (010)-(031); (000)-(101) and (010)-(111)
    Sums sums;
    add(sums, {28.5, 2 * kOmega2 + kOmega3, centre_2_7_long, bend_2_7}, nu, t);
    add(sums, {42.3, kOmega1 + kOmega3, centre_2_7_short, bend_2_7}, nu, t);
    return of(sums, t);
  }
  if (nu > 1975 && nu <= 2395) {
    Sums sums;
    add(sums, {2700, kOmega3, centre_4_3, [](int) { return 1.0; }}, nu, t);
    return of(sums, t);
  }
  if (nu > 880 && nu <= 1100) return band_10(nu, t);
  if (nu <= 880) return band_15(nu, t);
  return {};
}

}  // namespace irsig::plain
