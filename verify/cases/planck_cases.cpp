#include <array>
#include <cfloat>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/spectral/planck.h"
#include "verify/cases/groups.h"

// Planck's law against an independent evaluation in long double (64 bits of mantissa on x86, 15
// bits of exponent, so that it neither underflows nor overflows where double does), which is itself
// held against values in 40- and 60-digit arithmetic.
namespace irsig {
namespace {

static_assert(LDBL_MANT_DIG >= 64, "the reference needs a wider format than double");

using Wide = long double;
constexpr Wide kH = 6.62607015e-34L, kC = 299792458.0L, kK = 1.380649e-23L;
constexpr Wide kFirst = 2.0L * kH * kC * kC * 1e24L;  // W um^4 m^-2 sr^-1
constexpr Wide kSecond = kH * kC / kK * 1e6L;         // um K
constexpr Wide kWidePi = std::numbers::pi_v<Wide>;

Wide wide_radiance(Wide lambda_um, Wide temperature_k) {
  return kFirst / (powl(lambda_um, 5) * expm1l(kSecond / (lambda_um * temperature_k)));
}

Wide wide_derivative(Wide lambda_um, Wide temperature_k) {
  const Wide x = kSecond / (lambda_um * temperature_k);
  return wide_radiance(lambda_um, temperature_k) * x / (temperature_k * -expm1l(-x));
}

// Integral of t^3 / (e^t - 1) from x to infinity, x >= 1: the geometric series, term by term.
Wide upper_integral(Wide x) {
  Wide sum = 0;
  for (int n = 1; n < 200; ++n) {
    const Wide m = n;
    const Wide term = expl(-m * x) * (x * x * x / m + 3 * x * x / (m * m) + 6 * x / (m * m * m) +
                                      6 / (m * m * m * m));
    sum += term;
    if (term < 1e-22L * sum) break;
  }
  return sum;
}

// From 0 to x, x <= 1: the power series with Bernoulli's numbers, B_2k / (2k)! = 2 (-1)^(k+1)
// zeta(2k) / (2 pi)^2k.
Wide lower_integral(Wide x) {
  static const std::array<Wide, 16> coefficient = [] {
    std::array<Wide, 16> out{};
    for (int k = 1; k < 16; ++k) {
      Wide zeta = k == 1 ? kWidePi * kWidePi / 6 : k == 2 ? powl(kWidePi, 4) / 90 : 0;
      for (int n = 2000; k > 2 && n > 0; --n) zeta += powl(n, -2 * k);
      out[static_cast<std::size_t>(k)] = (k % 2 == 1 ? 2 : -2) * zeta / powl(2 * kWidePi, 2 * k);
    }
    return out;
  }();
  Wide sum = x * x * x / 3 - x * x * x * x / 8;
  for (int k = 1; k < 16; ++k)
    sum += coefficient[static_cast<std::size_t>(k)] * powl(x, 2 * k + 3) / (2 * k + 3);
  return sum;
}

Wide wide_band_radiance(Wide lambda_min_um, Wide lambda_max_um, Wide temperature_k) {
  const Wide low = kSecond / (lambda_max_um * temperature_k),
             high = kSecond / (lambda_min_um * temperature_k);
  Wide integral = 0;
  if (low >= 1)
    integral = upper_integral(low) - upper_integral(high);
  else if (high <= 1)
    integral = lower_integral(high) - lower_integral(low);
  else
    integral = powl(kWidePi, 4) / 15 - lower_integral(low) - upper_integral(high);
  return kFirst * powl(temperature_k / kSecond, 4) * integral;
}

// Relative to the true value; to the smallest normal double where the true value is smaller still
// (there, one unit in the last place is 2e-16 of it).
double error_of(double value, Wide expected) {
  return static_cast<double>(fabsl(value - expected) / std::max(expected, Wide{DBL_MIN}));
}

auto at(double lambda_um, double temperature_k) {
  return [=] { return absl::StrCat(lambda_um, " um, ", temperature_k, " K"); };
}

// f(lambda_um, temperature_k) over 0.1-1000 um and 1e-3-1e5 K: 20 steps a decade.
template <typename Function>
void over_the_range(Function&& f) {
  for (int i = 0; i <= 80; ++i)
    for (int k = 0; k <= 160; ++k) f(std::pow(10.0, -1 + i / 20.0), std::pow(10.0, -3 + k / 20.0));
}

constexpr double kTolerance = 2.5e-13;

absl::StatusOr<Finding> spectral(Effort) {
  Worst worst(kTolerance);
  over_the_range([&](double lambda_um, double t) {
    worst.see(error_of(planck_radiance_w_m2_sr_um(lambda_um, t), wide_radiance(lambda_um, t)),
              at(lambda_um, t));
  });
  return worst.finding();
}

absl::StatusOr<Finding> derivative(Effort) {
  Worst worst(kTolerance);
  over_the_range([&](double lambda_um, double t) {
    worst.see(error_of(planck_radiance_derivative_w_m2_sr_um_k(lambda_um, t),
                       wide_derivative(lambda_um, t)),
              at(lambda_um, t));
  });
  return worst.finding();
}

// Rows of tests/physics/values/planck_spectral.csv and planck_band.csv: 40- and 60-digit
// arithmetic.
struct SpectralValue {
  double lambda_um, temperature_k;
  Wide radiance;
};
struct BandValue {
  double lambda_min_um, lambda_max_um, temperature_k;
  Wide radiance;
};
constexpr SpectralValue kSpectralValues[] = {
    {9.2, 2.7, 5.0806351487379584e-249L},   {10.0, 50, 3.7920168559012118e-10L},
    {12.0, 200, 1.1955038581577456L},       {50, 240, 1.6451334499291559e-1L},
    {1000, 273.15, 2.2021508942153194e-6L}, {0.55, 300.15, 3.3355636953549122e-29L},
    {1.0, 306, 4.5279265411468866e-13L},    {3.0, 313.15, 1.0941042929230551e-1L},
    {3.8, 400, 1.1645791854964007e+1L},     {4.1, 800, 1.295409931715698e+3L},
    {8.0, 1500, 1.5689215182582434e+3L},    {9.6, 5772, 4.9268890068549003e+3L},
    {10.0, 100000, 8.2187538015496912e+4L},
};
constexpr BandValue kBandValues[] = {
    {3, 5, 50, 3.5375951560199348e-22L},         {3, 5, 400, 2.9847341493356399e+1L},
    {3.5, 4.1, 200, 6.3330489527127652e-4L},     {3.5, 4.1, 800, 7.9728447606818269e+2L},
    {8, 12, 240, 1.1445734503342288e+1L},        {8, 12, 1500, 3.2674859373982758e+3L},
    {8, 14, 273.15, 3.5151961968050168e+1L},     {8, 14, 5772, 2.2197824680640464e+4L},
    {0.4, 0.7, 293.15, 2.6197732980385603e-24L}, {0.4, 0.7, 100000, 3.0136508109924299e+9L},
    {8.5, 9.0, 300.15, 4.8656414352605307L},     {4.5, 5.0, 50, 3.5295310278364362e-22L},
    {4.5, 5.0, 400, 1.2654899182805953e+1L},
};

absl::StatusOr<Finding> digits(Effort) {
  Worst worst(kTolerance);
  for (const SpectralValue& v : kSpectralValues) {
    worst.see(error_of(planck_radiance_w_m2_sr_um(v.lambda_um, v.temperature_k), v.radiance),
              at(v.lambda_um, v.temperature_k));
    // The reference of the other cases must agree, too.
    worst.see(
        static_cast<double>(fabsl(wide_radiance(v.lambda_um, v.temperature_k) / v.radiance - 1)),
        at(v.lambda_um, v.temperature_k));
  }
  for (const BandValue& v : kBandValues) {
    const auto where = [&] {
      return absl::StrCat(v.lambda_min_um, "-", v.lambda_max_um, " um, ", v.temperature_k, " K");
    };
    worst.see(
        error_of(planck_band_radiance_w_m2_sr(v.lambda_min_um, v.lambda_max_um, v.temperature_k),
                 v.radiance),
        where);
    worst.see(
        static_cast<double>(fabsl(
            wide_band_radiance(v.lambda_min_um, v.lambda_max_um, v.temperature_k) / v.radiance -
            1)),
        where);
  }
  return worst.finding();
}

struct Limits {
  double min_um, max_um;
};
// From 1 % wide to ten decades.
constexpr std::array kBands = {Limits{0.1, 1000}, Limits{3, 5},      Limits{8, 12},
                               Limits{8.5, 9},    Limits{10, 10.1},  Limits{0.1, 0.2},
                               Limits{100, 1000}, Limits{1e-3, 1e7}, Limits{0.4, 14}};

absl::StatusOr<Finding> band(Effort) {
  Worst worst(kTolerance);
  for (const Limits& b : kBands)
    for (int k = 0; k <= 80; ++k) {
      const double t = std::pow(10.0, -3 + k / 10.0);
      worst.see(error_of(planck_band_radiance_w_m2_sr(b.min_um, b.max_um, t),
                         wide_band_radiance(b.min_um, b.max_um, t)),
                [&] { return absl::StrCat(b.min_um, "-", b.max_um, " um, ", t, " K"); });
    }
  return worst.finding();
}

// T^4: the band of all wavelengths that matter.
absl::StatusOr<Finding> stefan_boltzmann(Effort) {
  Worst worst(kTolerance);
  for (int k = 0; k <= 80; ++k) {
    const double t = std::pow(10.0, -3 + k / 10.0);
    // As long as planck.h's wavelengths reach: x from 1e-5 (what lies below is 3e-16 of the whole),
    // less far for T < 1.4 K, whose rest is the power series' business; up to 100 (1e-38).
    const auto second = static_cast<double>(kSecond);
    const double longest = std::min(second / (1e-5 * t), kPlanckLambdaMaxUm);
    const Wide whole = kFirst * powl(t / kSecond, 4) *
                       (powl(kWidePi, 4) / 15 - lower_integral(kSecond / (longest * t)));
    worst.see(error_of(planck_band_radiance_w_m2_sr(second / (100 * t), longest, t), whole),
              [&] { return absl::StrCat(t, " K"); });
  }
  return worst.finding();
}

// Through the underflow and through the switch of formulas: never less light from a hotter body,
// exactly none at 0 K and where the true value is less than half the smallest double.
absl::StatusOr<Finding> wien_tail(Effort effort) {
  Worst worst(kTolerance);
  const int steps = effort == Effort::kFull ? 2'000'000 : 200'000;
  for (const double lambda_um : {0.1, 0.4, 3.0, 10.0, 1000.0}) {
    worst.require(planck_radiance_w_m2_sr_um(lambda_um, 0) == 0, at(lambda_um, 0));
    worst.require(planck_radiance_derivative_w_m2_sr_um_k(lambda_um, 0) == 0, at(lambda_um, 0));
    worst.require(planck_band_radiance_w_m2_sr(lambda_um, 2 * lambda_um, 0) == 0, at(lambda_um, 0));
    double before = 0;
    for (int i = 0; i <= steps; ++i) {
      // x = c2 / (lambda T) from 800 to 600.
      const double x = 800 - 200.0 * i / steps;
      const double t = static_cast<double>(kSecond) / (lambda_um * x);
      const double value = planck_radiance_w_m2_sr_um(lambda_um, t);
      // A step of T is worth far more than the rounding of both.
      worst.require(std::isfinite(value) && value >= before, at(lambda_um, t));
      const Wide expected = wide_radiance(lambda_um, t);
      if (expected < Wide{DBL_TRUE_MIN} / 2) worst.require(value == 0, at(lambda_um, t));
      worst.see(error_of(value, expected), at(lambda_um, t));
      before = value;
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> inverse(Effort) {
  Worst worst(kTolerance);
  over_the_range([&](double lambda_um, double t) {
    const double radiance = planck_radiance_w_m2_sr_um(lambda_um, t);
    if (radiance < DBL_MIN) return;  // too few digits for a temperature
    worst.see(std::abs(monochromatic_temperature_k(lambda_um, radiance) / t - 1), at(lambda_um, t));
  });
  for (const Limits& b : kBands)
    for (int k = 0; k <= 80; ++k) {
      const double t = std::pow(10.0, -3 + k / 10.0);
      const double radiance = planck_band_radiance_w_m2_sr(b.min_um, b.max_um, t);
      if (radiance < DBL_MIN) continue;
      worst.see(std::abs(radiance_temperature_k(b.min_um, b.max_um, radiance) / t - 1),
                [&] { return absl::StrCat(b.min_um, "-", b.max_um, " um, ", t, " K"); });
    }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> planck_cases() {
  const std::string kClosedForm =
      "c2 / (lambda T) is rounded three times (3.3e-16), which the exponential magnifies by its "
      "exponent, 745 at most before the result is 0: 2.5e-13";
  return {
      {"planck", "spectral", "spectral radiance, 0.1-1000 um x 1e-3-1e5 K, relative error",
       kClosedForm, spectral},
      {"planck", "derivative", "d/dT of it, relative error", kClosedForm, derivative},
      {"planck", "digits",
       "spectral and band radiance, and the long-double reference, against 40 to 60 digits",
       kClosedForm, digits},
      {"planck", "band", "band radiance, 1 % wide to ten decades, 1e-3-1e5 K, relative error",
       kClosedForm, band},
      {"planck", "stefan_boltzmann", "all wavelengths against sigma T^4 / pi, 1e-3-1e5 K, relative",
       "what the limits leave out is subtracted; the rest as for a band", stefan_boltzmann},
      {"planck", "wien_tail",
       "0 K, underflow, steps of 1e-6 in T: relative error; never falling, exactly 0 at the end",
       "as for the spectral radiance; below half the smallest double the nearest double is 0",
       wien_tail},
      {"planck", "inverse", "temperature of a radiance of T, relative error",
       "that of the radiance (2.5e-13) divided by d ln L / d ln T >= 1", inverse},
  };
}

}  // namespace irsig
