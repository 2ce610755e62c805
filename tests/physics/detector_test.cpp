// Rationale: a detector's figures become one signal-to-noise ratio.
// Expected: closed forms and independent arithmetic: photons counted one wavelength at a time,
// noise-equivalent temperatures by the difference of two blackbodies in the band. Source:
// [dereniak1996]; Planck's law as tested in planck_test.cpp.

#include "core/detector/detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/spectral/planck.h"

namespace irsig {
namespace {

double integral(const std::vector<SpectralPoint>& table) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < table.size(); ++i)
    sum +=
        0.5 * (table[i + 1].lambda_um - table[i].lambda_um) * (table[i].value + table[i + 1].value);
  return sum;
}

TEST(Detector, ConstantNoiseIsWhatIsStated) {
  const DetectorIntegrals d = integrals_of({{{3, 1}, {5, 0.5}}, ConstantNoise{2e-9}});
  EXPECT_DOUBLE_EQ(d.variance(0), 4e-18);
  EXPECT_TRUE(d.photons.empty());
}

// A temperature difference of NETD on one pixel makes a signal of the noise, whatever the band.
TEST(Detector, NetdIsTheDifferenceOfTwoBlackbodies) {
  for (const auto& [low, high] : {std::pair{3.0, 5.0}, {8.0, 12.0}, {3.9, 3.95}}) {
    const double ifov = 2e-4, netd = 0.02;
    const double nei = nei_of_netd_w_m2({{low, 1}, {high, 1}}, netd, 300, 2, 2, ifov * ifov);
    const double light = (planck_band_radiance_w_m2_sr(low, high, 300 + netd / 2) -
                          planck_band_radiance_w_m2_sr(low, high, 300 - netd / 2)) *
                         ifov * ifov;
    EXPECT_NEAR(nei / light, 1, 1e-6);
    // Half the light from optics of 1.4 times the f-number: twice the noise.
    EXPECT_NEAR(
        nei_of_netd_w_m2({{low, 1}, {high, 1}}, netd, 300, 2, 2 * std::sqrt(2.0), ifov * ifov) /
            nei,
        2, 1e-12);
  }
}

TEST(Detector, DetectivityOfAnAreaAndABandwidth) {
  // 1e11 cm sqrt(Hz) / W, 100 um square, 1 kHz: 3.16e-12 W on the detector, through 10 cm.
  const double nei = nei_of_d_star_w_m2(1e9, 1e-8, 1e3, 0.1, 0.5);
  EXPECT_NEAR(nei, 3.1622776601683795e-12 / (0.5 * std::numbers::pi * 0.01 / 4), 1e-22);
}

TEST(Detector, PhotonsAreCountedOneByOne) {
  const PhotonNoise noise{0.1, 0.7, 2.5, 15e-6, 1e-3, 1e12, 100};
  const double efficiency = 0.6, um = 4;
  // In so narrow a band all photons have the same energy.
  const DetectorIntegrals d =
      integrals_of({{{um - 1e-4, efficiency}, {um + 1e-4, efficiency}}, noise});
  const double photon_j = 6.62607015e-34 * 299792458.0 / (um * 1e-6);
  const double aperture_m2 = std::numbers::pi * 0.01 / 4, pixel_sr = std::pow(15e-6 / 0.25, 2);
  const double per_w_m2 = aperture_m2 * 0.7 * 1e-3 * efficiency / photon_j;
  EXPECT_NEAR(integral(d.signal) / (2e-4 * per_w_m2), 1, 1e-9);
  EXPECT_NEAR(integral(d.photons) / (2e-4 * per_w_m2 * pixel_sr), 1, 1e-9);
  EXPECT_DOUBLE_EQ(d.variance(30000), 30000 + 1e4);
}

// A product with the wavelength is a parabola: chords of it are dense enough.
TEST(Detector, TablesAreDenseEnough) {
  const DetectorIntegrals d =
      integrals_of({{{3, 0}, {5, 0.8}, {12, 0.2}}, PhotonNoise{1, 1, 1, 1, 1, 1e30, 0}});
  const double per_j = std::numbers::pi / 4 * 1e-6 / (6.62607015e-34 * 299792458.0);
  // Integral of efficiency x wavelength, each piece a cubic.
  const auto piece = [](double a, double b, double ya, double yb) {
    const double slope = (yb - ya) / (b - a);
    return (ya - slope * a) * (b * b - a * a) / 2 + slope * (b * b * b - a * a * a) / 3;
  };
  const double expected = per_j * (piece(3, 5, 0, 0.8) + piece(5, 12, 0.8, 0.2));
  EXPECT_NEAR(integral(d.signal) / expected, 1, 1e-7);
}

TEST(Detector, TheWellEndsTheIntegration) {
  const DetectorIntegrals d = integrals_of({{{3, 1}, {5, 1}}, PhotonNoise{1, 1, 1, 1, 1, 1e6, 50}});
  EXPECT_DOUBLE_EQ(d.variance(1e6), 1e6 + 2500);
  // A quarter of the time has a quarter of the signal.
  EXPECT_DOUBLE_EQ(250 / 1000.0 * std::sqrt(d.variance(4e6)), std::sqrt(1e6 + 2500));
}

// One after another: cubics are integrated beside their chords; edges are kept, and so is nothing.
TEST(Detector, ResponsesOneAfterAnother) {
  const std::vector<SpectralPoint> a = {{3, 0.2}, {4, 0.9}, {5, 0.1}}, b = {{3.5, 1}, {4.6, 0.3}};
  const auto both = product(a, b);
  EXPECT_DOUBLE_EQ(both.front().lambda_um, 3.5);
  EXPECT_DOUBLE_EQ(both.back().lambda_um, 4.6);
  const auto exact = [](double x) {
    const double first = x < 4 ? 0.2 + 0.7 * (x - 3) : 0.9 - 0.8 * (x - 4);
    return first * (1 - 0.7 * (x - 3.5) / 1.1);
  };
  // Simpson's rule is exact for parabolas.
  const auto simpson = [&](double from, double to) {
    return (to - from) / 6 * (exact(from) + 4 * exact((from + to) / 2) + exact(to));
  };
  EXPECT_NEAR(integral(both) / (simpson(3.5, 4) + simpson(4, 4.6)), 1, 1e-7);
  EXPECT_TRUE(product(a, {{5, 1}, {6, 1}}).empty());
  EXPECT_TRUE(product(a, {{3, 0}, {5, 0}}).empty());
}

}  // namespace
}  // namespace irsig
