#include <algorithm>
#include <array>
#include <cmath>

#include "core/gas/gas_loops.h"
#include "core/gas/narrow_band_tables.h"

namespace irsig {
namespace {

// Fundamentals [cm-1]; the mean of the two lower ones counts for both.
constexpr double kOmega1 = 1354.91, kOmega2 = 673, kOmega3 = 2396.49;
constexpr double kOmega12 = 0.5 * (0.5 * kOmega1 + kOmega2);
constexpr double kB = kCo2RotationCm1, kA = kCo2RotationChangeCm1;
constexpr double kLinesPerCm1 = 1 / (4 * kB);  // of a band without hot ones

// Bands that end on v3 + 1 from all levels below, each a P and an R branch of smeared-out lines.
//   strength      of the band at 300 K                                   [cm-2 atm-1]
//   combination   of its transition                                      [cm-1]
//   centre, bend  of level (v, v3): band centre; relative strength beside the harmonic v3 + 1
struct HotBands {
  double strength, combination;
  double (*centre)(int v, int v3);
  double (*bend)(int v);
};

double centre_2_7_long(int v, int v3) {
  return v == 0 ? 3613 - 47.0 * v3 : 3598 - 18.0 * v - 47.0 * v3;
}
double centre_2_7_short(int v, int v3) {
  return v == 0 ? 3715 - 47.0 * v3 : 3728 - 5.0 * v - 47.0 * v3;
}
double bend_2_7(int v) { return v % 2 == 1 ? (v + 5) / 6.0 : (v + 3.0) * (v + 4) / (v + 2) / 6; }

// (000)-(021) and (010)-(031); (000)-(101) and (010)-(111)
constexpr std::array<HotBands, 2> kBands27 = {
    {{28.5, 2 * kOmega2 + kOmega3, centre_2_7_long, bend_2_7},
     {42.3, kOmega1 + kOmega3, centre_2_7_short, bend_2_7}}};

double occupied_fraction(double energy, double temperature) {
  return 1 - std::exp(-kRadcalC2CmK * energy / temperature);
}
double filling(const HotBands& bands, double temperature) {
  return occupied_fraction(kOmega3, temperature) *
         std::pow(occupied_fraction(kOmega12, temperature), 3) *
         (2 - occupied_fraction(kOmega12, temperature)) *
         occupied_fraction(bands.combination, temperature);
}

void fill(const HotBands& bands, double t, HotLevels& out) {
  constexpr std::size_t kLevels = HotLevels::kV * HotLevels::kV3;
  double exponent[2 * kLevels], e[2 * kLevels];
  for (std::size_t n = 0; n < kLevels; ++n) {
    const int v = static_cast<int>(n / HotLevels::kV3), v3 = static_cast<int>(n % HotLevels::kV3);
    const double centre = bands.centre(v, v3);
    out.centre_cm1[n / HotLevels::kV3][n % HotLevels::kV3] = centre;
    exponent[n] = -(v3 * kOmega3 + v * kOmega12) * kRadcalC2CmK / t;
    exponent[kLevels + n] = -kRadcalC2CmK * centre / t;
  }
  exp_of(2 * kLevels, exponent, e);
  for (std::size_t n = 0; n < kLevels; ++n) {
    const int v = static_cast<int>(n / HotLevels::kV3), v3 = static_cast<int>(n % HotLevels::kV3);
    const double states = v % 2 == 1 ? 0.25 * (v + 1) * (v + 3) : 0.25 * (v + 2) * (v + 2);
    out.filled[n / HotLevels::kV3][n % HotLevels::kV3] =
        (v3 + 1) * states * bands.bend(v) * e[n] / (bands.centre(v, v3) * (1 - e[kLevels + n]));
  }
}

// Those at 2.7 um.
void bands_2_7(std::span<const double> nu, double t, std::span<NarrowBand> out) {
  HotLevels levels[kBands27.size()];
  double common[kBands27.size()];
  for (std::size_t k = 0; k < kBands27.size(); ++k) {
    const HotBands& bands = kBands27[k];
    fill(bands, t, levels[k]);
    common[k] = bands.strength * kB * kRadcalC2CmK / (kA * filling(bands, kRadcalT0K)) *
                filling(bands, t) * kRadcalT0K / (t * t);
  }
  for (std::size_t first = 0; first < nu.size(); first += kGasLanes) {
    const std::size_t count = std::min(kGasLanes, nu.size() - first);
    double at[kGasLanes], scale[kGasLanes];
    HotBandSums sums;
    for (std::size_t j = 0; j < kGasLanes; ++j) at[j] = nu[first + std::min(j, count - 1)];
    for (std::size_t k = 0; k < kBands27.size(); ++k) {
      for (std::size_t j = 0; j < kGasLanes; ++j)
        scale[j] = common[k] * occupied_fraction(at[j], t) * at[j];
      add_hot_bands(levels[k], t, at, scale, sums);
    }
    for (std::size_t j = 0; j < count; ++j) {
      const double weak = sums.weak[j], strong = sums.strong[j];
      out[first + j] = weak > 0 && strong > 0 ? NarrowBand{weak * t / 273, strong * strong / weak}
                                              : NarrowBand{};
    }
  }
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

bool at_2_7(double nu) { return nu > 3050 && nu <= 3800; }

NarrowBand co2_band(double nu, double t) {
  if (nu > 5725 || nu <= 500) return {};
  if (nu > 4550) return band_2_0(nu, t);
  if (nu > 880 && nu <= 1100) return band_10(nu, t);
  if (nu <= 880) return band_15(nu, t);
  return {};  // 1970-2460 cm-1: hot_lines.h
}

}  // namespace

void co2_bands(std::span<const double> nu, double t, std::span<NarrowBand> out) {
  for (std::size_t i = 0; i < nu.size();) {
    std::size_t last = i;
    while (last < nu.size() && at_2_7(nu[last])) ++last;
    if (last > i) {
      bands_2_7(nu.subspan(i, last - i), t, out.subspan(i, last - i));
      i = last;
    } else {
      out[i] = co2_band(nu[i], t);
      ++i;
    }
  }
}

}  // namespace irsig
