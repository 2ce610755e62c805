// Rationale: a stated model error of hot gas is as large as what its bands get wrong. Expected: the
// deviations from line by line, over the stated sigma, have an rms of 0.7 to 1.4 in each window.
// Source: ratios of this program's exhaust columns to a line-by-line reference, as they were
// measured; total emissivities of water against Leckner's chart are within 10 % (gas_test.cpp).
#include <gtest/gtest.h>

#include <cmath>

#include "core/hot_gas/column_spectra.h"
#include "core/hot_gas/gas_model_error.h"

namespace irsig {
namespace {

// A column of exhaust: 5 % of carbon dioxide and of water.
GasColumn exhaust(double temperature_k, double length_m) {
  constexpr double kGasConstant = 8.314462618;
  GasSegment s;
  s.end_m = length_m;
  s.temperature_k = temperature_k;
  s.pressure_pa = 101325;
  s.weight = s.pressure_pa / (kGasConstant * temperature_k) * length_m;
  s.amount = {0.05 * s.weight, 0.05 * s.weight, 0, 0};
  return {s};
}

struct Sent {
  double value = 0, sigma = 0;
};
Sent in_band(double temperature_k, double length_m, double from_um, double to_um) {
  std::vector<double> um;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) um.push_back(from_um + (to_um - from_um) * (i + 0.5) / kSteps);
  const auto wavelengths = GasWavelengths::make(um);
  EXPECT_TRUE(wavelengths.ok());
  const auto column = HotColumn::make(exhaust(temperature_k, length_m), *wavelengths);
  EXPECT_TRUE(column.ok());
  const ColumnLight light = column->at_near_end();
  Sent out;
  for (std::size_t i = 0; i < um.size(); ++i) {
    out.value += light.emitted_w_m2_sr_um[i];
    out.sigma += light.model_error_w_m2_sr_um[i];
  }
  return out;
}

struct Ratio {
  double temperature_k, ours_over_exact;
};
double rms_z(std::initializer_list<Ratio> ratios, double from_um, double to_um) {
  double squares = 0;
  for (const Ratio& r : ratios) {
    const Sent sent = in_band(r.temperature_k, 1, from_um, to_um);
    const double z = sent.value * (1 - 1 / r.ours_over_exact) / sent.sigma;
    std::printf("%4.1f-%4.1f um %4.0f K: ratio %.3f, sigma %.3f, z %5.2f\n", from_um, to_um,
                r.temperature_k, r.ours_over_exact, sent.sigma / sent.value, z);
    squares += z * z;
  }
  return std::sqrt(squares / static_cast<double>(ratios.size()));
}

TEST(HotGasError, IsWhatBandsGetWrong) {
  const double window = rms_z({{500, 1.15}, {700, 1.08}, {1000, 1.125}, {1300, 1.22}}, 8, 12),
               middle = rms_z({{500, 1.41}, {700, 0.87}, {800, 0.74}, {900, 0.69}, {1000, 0.67}},
                              3.4, 4.1),
               red = rms_z({{700, 0.863}, {800, 0.834}}, 4.5, 5);
  // Of the whole of 3-5 um the mean ratio and its scatter are known: 1.015 and 0.022.
  double all = 0;
  for (const double kelvin : {700.0, 900.0, 1100.0}) {
    const Sent sent = in_band(kelvin, 1, 3, 5);
    const double z = std::hypot(0.015, 0.022) / (sent.sigma / sent.value);
    all += z * z / 3;
  }
  all = std::sqrt(all);
  std::printf("rms z %.2f %.2f %.2f %.2f\n", window, middle, red, all);
  for (const double rms : {window, middle, red, all}) {
    EXPECT_GT(rms, 0.7);
    EXPECT_LT(rms, 1.4);
  }
}

// Where a gas is black its emission is known, whatever its depth.
TEST(HotGasError, FallsWhereGasIsThick) {
  const Sent thin = in_band(700, 1e-3, 4.2, 4.4), thick = in_band(700, 1000, 4.2, 4.4);
  EXPECT_NEAR(thin.sigma / thin.value, 0.07, 0.02);
  EXPECT_LT(thick.sigma, 1e-3 * thick.value);
}

// Hotter gas than was compared has larger errors, without a step.
TEST(HotGasError, GrowsBeyondWhatWasCompared) {
  for (const double nu : {600.0, 1000.0, 2100.0, 2300.0, 2700.0, 3500.0, 5000.0}) {
    const double at_1500_k = hot_depth_error(nu, 1500);
    EXPECT_NEAR(hot_depth_error(nu, 1501), at_1500_k, 3e-3 * at_1500_k);
    EXPECT_NEAR(hot_depth_error(nu, 3000), 4 * at_1500_k, 1e-12);
    EXPECT_NEAR(hot_depth_error(nu, 2000), 2 * at_1500_k, 1e-12);
  }
}

TEST(HotGasError, IsOfTheGasesNotOfSoot) {
  GasColumn column = exhaust(700, 1);
  const double alone = absorptance_error(0.1, 1000, exhaust(700, 1), 700);
  EXPECT_NEAR(alone, 0.1 * 0.15, 0.004);
  column[0].amount[3] = 1;  // all of it
  EXPECT_EQ(absorptance_error(0.1, 1000, column, 700), 0);
}

}  // namespace
}  // namespace irsig
