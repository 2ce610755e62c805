// Rationale: every radiance of the project is made of these functions; an error here is in every
// result, and the
//   traps are numerical (overflow at small lambda T, cancellation in narrow bands, underflow to 0).
// Expected: relative error <= 1e-12 wherever the true value is a normal double. The closed form
// alone loses at most
//   the exponent times the rounding of c2 / (lambda T): 740 x 3 x 1.1e-16 = 2.5e-13.
// Source: tests/physics/values/planck_*.csv, radiance_temperature.csv, radiation_constants.csv (40
// to 60 digits).
#include "core/spectral/planck.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "tests/physics/reference_table.h"

namespace irsig {
namespace {

constexpr double kTolerance = 1e-12;

// The largest relative error seen, printed and recorded with the test's results.
class Worst {
 public:
  void see(double value, double expected) {
    if (expected < DBL_MIN) {
      // Below the normal doubles there are fewer digits; at 0 exactly there must be none of the
      // value left.
      EXPECT_NEAR(value, expected, 1e-12 * DBL_MIN + 2 * DBL_TRUE_MIN);
      if (expected == 0.0) {
        EXPECT_EQ(value, 0.0);
      }
      return;
    }
    const double error = std::abs(value / expected - 1.0);
    EXPECT_LE(error, kTolerance) << value << " against " << expected;
    largest_ = std::max(largest_, error);
    ++seen_;
  }
  void report(const char* what, std::size_t at_least) const {
    EXPECT_GE(seen_, at_least);
    std::printf("%s: largest relative error %.2g in %zu values\n", what, largest_, seen_);
  }

 private:
  double largest_ = 0.0;
  std::size_t seen_ = 0;
};

TEST(Planck, ConstantsAreTheExactQuotients) {
  const ReferenceTable table("radiation_constants.csv");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string& name = table.text(i, "name");
    const double value = table.number(i, "value");
    if (name == "c1L_um") {
      EXPECT_EQ(kC1LWUm4M2Sr, value);
    }
    if (name == "c2") {
      EXPECT_NEAR(kC2UmK / 1e6 / value, 1.0, 2.3e-16);
    }
    if (name == "sigma") {  // the integral over (nearly) all wavelengths; 1e-13 of it lies outside
      EXPECT_NEAR(std::numbers::pi * planck_band_radiance_w_m2_sr(1e-2, 1e8, 300.0) /
                      (value * std::pow(300.0, 4)),
                  1.0, kTolerance);
    }
  }
  EXPECT_NEAR(kC1LWUm4M2Sr / (2e24 * kPlanckJS * kLightSpeedMS * kLightSpeedMS), 1.0, 5e-16);
  EXPECT_NEAR(kC2UmK / (1e6 * kPlanckJS * kLightSpeedMS / kBoltzmannJK), 1.0, 5e-16);
}

TEST(Planck, SpectralRadianceAndDerivative) {
  const ReferenceTable table("planck_spectral.csv");
  Worst radiance;
  Worst derivative;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double lambda_um = table.number(i, "lambda_um");
    const double temperature_k = table.number(i, "temperature_k");
    SCOPED_TRACE(testing::Message() << lambda_um << " um, " << temperature_k << " K");
    radiance.see(planck_radiance_w_m2_sr_um(lambda_um, temperature_k),
                 table.number(i, "spectral_radiance_w_m2_sr_um"));
    derivative.see(planck_radiance_derivative_w_m2_sr_um_k(lambda_um, temperature_k),
                   table.number(i, "derivative_w_m2_sr_um_k"));
  }
  radiance.report("spectral radiance", 150);
  derivative.report("its derivative", 150);
}

TEST(Planck, BandRadianceAndDerivative) {
  const ReferenceTable table("planck_band.csv");
  Worst radiance;
  Worst derivative;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double low = table.number(i, "lambda_min_um");
    const double high = table.number(i, "lambda_max_um");
    const double temperature_k = table.number(i, "temperature_k");
    SCOPED_TRACE(testing::Message() << low << "-" << high << " um, " << temperature_k << " K");
    radiance.see(planck_band_radiance_w_m2_sr(low, high, temperature_k),
                 table.number(i, "radiance_w_m2_sr"));
    derivative.see(planck_band_radiance_derivative_w_m2_sr_k(low, high, temperature_k),
                   table.number(i, "derivative_w_m2_sr_k"));
  }
  radiance.report("band radiance", 55);
  derivative.report("its derivative", 55);
}

TEST(Planck, ApparentTemperature) {
  const ReferenceTable table("radiance_temperature.csv");
  Worst temperature;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double low = table.number(i, "lambda_min_um");
    const double high = table.number(i, "lambda_max_um");
    const double radiance = table.number(i, "radiance");
    SCOPED_TRACE(testing::Message() << low << "-" << high << " um, " << radiance);
    temperature.see(low == high ? monochromatic_temperature_k(low, radiance)
                                : radiance_temperature_k(low, high, radiance),
                    table.number(i, "radiance_temperature_k"));
  }
  temperature.report("radiance temperature", 60);
}

// The inverse is the inverse of the forward function over far more than any sensor sees. The
// relative error of T is that of L divided by T L' / L >= 1.
TEST(Planck, InverseOfForwardOverTheWholeRange) {
  struct Limits {
    double low, high;
  };
  Worst worst;
  for (const Limits band : {Limits{3, 5}, Limits{8, 12}, Limits{8.5, 9}, Limits{0.4, 0.7},
                            Limits{0.1, 1000}, Limits{10, 10.000001}, Limits{1e-3, 1e6}}) {
    for (double temperature_k = 1.0; temperature_k < 1e9; temperature_k *= 1.7) {
      const double radiance = planck_band_radiance_w_m2_sr(band.low, band.high, temperature_k);
      if (radiance < DBL_MIN) continue;
      SCOPED_TRACE(testing::Message() << band.low << "-" << band.high << " um, " << temperature_k);
      worst.see(radiance_temperature_k(band.low, band.high, radiance), temperature_k);
    }
  }
  worst.report("round trip", 200);
}

// Cutting a band in two changes nothing; a band of relative width 2e-9 has the radiance of its
// middle.
TEST(Planck, BandsAddUpAndShrink) {
  Worst worst;
  for (const double temperature_k : {30.0, 250.0, 1000.0, 6000.0}) {
    const double whole = planck_band_radiance_w_m2_sr(3, 14, temperature_k);
    worst.see(planck_band_radiance_w_m2_sr(3, 3.7, temperature_k) +
                  planck_band_radiance_w_m2_sr(3.7, 14, temperature_k),
              whole);
    const double low = 5.0;
    const double high = 5.0 + 1e-8;
    worst.see(planck_band_radiance_w_m2_sr(low, high, temperature_k) / (high - low),
              planck_radiance_w_m2_sr_um(0.5 * (low + high), temperature_k));
    EXPECT_EQ(planck_band_radiance_w_m2_sr(4, 4, temperature_k), 0.0);
  }
  worst.report("sums and narrow bands", 8);
}

TEST(Planck, NothingIsEmittedAtZeroKelvin) {
  for (const double lambda_um : {1e-6, 0.3, 10.0, 1e9}) {
    EXPECT_EQ(planck_radiance_w_m2_sr_um(lambda_um, 0.0), 0.0);
    EXPECT_EQ(planck_radiance_derivative_w_m2_sr_um_k(lambda_um, 0.0), 0.0);
  }
  EXPECT_EQ(planck_band_radiance_w_m2_sr(3, 5, 0.0), 0.0);
  EXPECT_EQ(planck_band_radiance_derivative_w_m2_sr_k(3, 5, 0.0), 0.0);
  EXPECT_EQ(radiance_temperature_k(3, 5, 0.0), 0.0);
  EXPECT_EQ(monochromatic_temperature_k(10, 0.0), 0.0);
}

TEST(Planck, NoArgumentGivesNanOrInfinity) {
  for (double lambda_um = 1e-6; lambda_um < 1e9; lambda_um *= 7.0) {
    for (const double temperature_k : {5e-324, 1e-200, 1e-3, 1.0, 1e3, 1e6, 1e12}) {
      EXPECT_TRUE(std::isfinite(planck_radiance_w_m2_sr_um(lambda_um, temperature_k)));
      EXPECT_TRUE(std::isfinite(planck_radiance_derivative_w_m2_sr_um_k(lambda_um, temperature_k)));
      const double band = planck_band_radiance_w_m2_sr(lambda_um, 1.1 * lambda_um, temperature_k);
      EXPECT_TRUE(std::isfinite(band) && band >= 0.0) << lambda_um << " um, " << temperature_k;
    }
    const double most =
        planck_band_radiance_w_m2_sr(lambda_um, 1.1 * lambda_um, kPlanckTemperatureMaxK);
    for (const double radiance : {5e-324, 1e-300, 1e-30, 1e-9 * most, most}) {
      const double temperature_k = radiance_temperature_k(lambda_um, 1.1 * lambda_um, radiance);
      EXPECT_TRUE(std::isfinite(temperature_k) && temperature_k > 0.0)
          << lambda_um << " um, " << radiance;
    }
  }
}

// A radiance comes out of a calculation; one that no blackbody has must not end the process.
TEST(Planck, ARadianceThatNoBlackbodyHasIsGivenNoTemperature) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double radiance : {-1.0, -5e-324, std::nan(""), infinite, -infinite, 1e200, 1e300}) {
    EXPECT_TRUE(std::isnan(radiance_temperature_k(3, 5, radiance))) << radiance;
    EXPECT_TRUE(std::isnan(monochromatic_temperature_k(10, radiance))) << radiance;
  }
  const double most = planck_radiance_w_m2_sr_um(10, kPlanckTemperatureMaxK);
  EXPECT_NEAR(monochromatic_temperature_k(10, most) / kPlanckTemperatureMaxK, 1, 1e-9);
  EXPECT_TRUE(std::isnan(monochromatic_temperature_k(10, 1.001 * most)));
}

TEST(PlanckDeathTest, ImpossibleArgumentsAreNamed) {
  EXPECT_DEATH((void)planck_radiance_w_m2_sr_um(10, -1), "temperature_k >= 0.0.*-1 against 0");
  EXPECT_DEATH((void)planck_band_radiance_w_m2_sr(5, 3, 300), "lambda_min_um <= lambda_max_um");
}

}  // namespace
}  // namespace irsig
