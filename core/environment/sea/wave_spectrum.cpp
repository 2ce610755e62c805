#include "core/environment/sea/wave_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"

namespace irsig {
namespace {

constexpr double kLeastLagM = 1e-4, kMostLagM = 1e4;
constexpr std::size_t kWaves = 400;

double sinc(double x) { return x < 1e-6 ? 1 : std::sin(x) / x; }

}  // namespace

double wave_spectrum_m3(double k, double wind_m_s) {
  constexpr double kAge = 0.84;  // inverse wave age of a fully developed sea
  constexpr double kSlowestMS = 0.23,
                   kShortest = 2 * kStandardGravityMS2 / (kSlowestMS * kSlowestMS);
  const auto speed = [](double of) {
    return std::sqrt(kStandardGravityMS2 / of * (1 + of * of / (kShortest * kShortest)));
  };
  const double peak = kStandardGravityMS2 * kAge * kAge / (wind_m_s * wind_m_s), c = speed(k);
  const double friction = wind_m_s * std::sqrt(1e-3 * (0.8 + 0.065 * wind_m_s));

  const double root = std::sqrt(k / peak), width = 0.08 * (1 + 4 / (kAge * kAge * kAge));
  const double decay = std::exp(-1.25 * peak * peak / (k * k));
  const double enhancement =
      std::pow(1.7, std::exp(-(root - 1) * (root - 1) / (2 * width * width)));
  const double lasting = decay * enhancement;
  const double long_waves = 0.5 * 6e-3 * std::sqrt(kAge) * speed(peak) / c * lasting *
                            std::exp(-kAge / std::sqrt(10.0) * (root - 1));

  const double growth = std::log(friction / kSlowestMS);
  const double level = std::max(0.0, 1e-2 * (1 + (friction > kSlowestMS ? 3 : 1) * growth));
  const double off = k / kShortest - 1;
  const double short_waves = 0.5 * level * kSlowestMS / c * lasting * std::exp(-0.25 * off * off);
  return (long_waves + short_waves) / (k * k * k);
}

SlopeCorrelation::SlopeCorrelation(double wind_m_s) {
  const double wind = std::max(wind_m_s, 0.5);
  const double first = std::log(0.05 * kStandardGravityMS2 / (wind * wind)), last = std::log(5e3);
  const double step = (last - first) / kWaves;
  double sum = 0;
  for (std::size_t i = 0; i < kWaves; ++i) {
    const double k = std::exp(first + (static_cast<double>(i) + 0.5) * step);
    k_.push_back(k);
    share_.push_back(k * k * k * wave_spectrum_m3(k, wind));
    sum += share_.back();
  }
  for (double& s : share_) s /= sum;
  for (std::size_t j = 0; j < kLags; ++j) {
    const double r =
        kLeastLagM * std::pow(kMostLagM / kLeastLagM, static_cast<double>(j) / (kLags - 1));
    for (std::size_t i = 0; i < kWaves; ++i) {
      // Mean over the waves of a step: beyond the first zero of the sinc what is left cancels.
      const double x = k_[i] * r, turned = 0.5 * x * step;
      if (turned >= std::numbers::pi) break;
      const double j0 = ::j0(x), j2 = x < 1e-3 ? x * x / 8 : 2 * ::j1(x) / x - j0;
      m0_[j] += share_[i] * sinc(turned) * j0;
      m2_[j] += share_[i] * sinc(turned) * j2;
    }
  }
}

SlopeCorrelation::Pair SlopeCorrelation::at(double x_m, double y_m) const {
  const double r = std::hypot(x_m, y_m);
  if (r <= kLeastLagM) return {1, 1};
  const double place = std::log(r / kLeastLagM) / std::log(kMostLagM / kLeastLagM) * (kLags - 1);
  const std::size_t j = std::min(static_cast<std::size_t>(place), kLags - 2);
  const double f = std::min(1.0, place - static_cast<double>(j));
  const double m0 = std::lerp(m0_[j], m0_[j + 1], f), m2 = std::lerp(m2_[j], m2_[j + 1], f);
  const double turned = (x_m * x_m - y_m * y_m) / (r * r);  // cosine of twice the azimuth
  return {m0 - m2 * turned, m0 + m2 * turned};
}

SlopeCorrelation::Pair SlopeCorrelation::variance_of_mean(double x_m, double y_m) const {
  constexpr int kAzimuths = 32;
  Pair out{0, 0};
  for (int a = 0; a < kAzimuths; ++a) {
    const double turn = 0.5 * std::numbers::pi * (a + 0.5) / kAzimuths;
    const double cosine = std::cos(turn), sine = std::sin(turn);
    for (std::size_t i = 0; i < kWaves; ++i) {
      const double along = sinc(0.5 * k_[i] * cosine * x_m),
                   across = sinc(0.5 * k_[i] * sine * y_m);
      const double left = share_[i] * along * along * across * across * 2 / kAzimuths;
      out.x += left * cosine * cosine;
      out.y += left * sine * sine;
    }
  }
  return out;
}

}  // namespace irsig
