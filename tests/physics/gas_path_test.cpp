// Rationale: the loops over many bands at once do what the formulas say.
// Expected: spectra of the formulas one by one, to 1e-10 of the value (and 1e-11 of transmittance),
// for paths thin and thick, cold and hot, in all bands, alone and behind dry, humid, short and long
// air. Source: tests/physics/plain_gas.
#include "core/gas/gas_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/atmosphere/atmosphere.h"
#include "core/gas/gas_spectrum.h"
#include "tests/physics/plain_gas/plain_gas.h"

namespace irsig {
namespace {

std::vector<std::vector<GasLayer>> paths() {
  std::vector<std::vector<GasLayer>> out = {
      {},
      {{{900, 101325, 0, 0, 0, 0}, 1}},
      {{{900, 101325, 0, 0, 0, 1e-7}, 1}},
      {{{200, 10132.5, 1, 0, 0, 0}, 1e-12}, {{2000, 202650, 0, 1, 0, 0}, 1e6}},
      {{{250, 101325, 0, 0.1, 0, 0}, 5}, {{2000, 101325, 0.1, 0.1, 0.1, 1e-8}, 3}},
      {{{1500, 101325, 0.2, 0.1, 0.01, 0}, 0}, {{1500, 101325, 0.2, 0.1, 0.01, 0}, 1e-9}},
      {{{1500, 101325, 0, 0, 1, 0}, 1e-290}, {{600, 5e4, 0.3, 0.3, 0.3, 1e-6}, 1e4}}};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(0, 1);
  for (int n = 0; n < 40; ++n) {
    std::vector<GasLayer>& path = out.emplace_back();
    const int layers = 1 + n % 12;
    for (int i = 0; i < layers; ++i) {
      const double t = 200 + 1800 * u(random) * u(random);
      path.push_back({{t, n % 2 == 0 ? 101325 : 10132.5 + 190000 * u(random),
                       n % 5 == 0 ? 0 : 0.3 * u(random), n % 7 == 0 ? 0 : 0.3 * u(random),
                       n % 3 == 0 ? 0 : 0.1 * u(random), n % 4 == 0 ? 0 : 1e-6 * u(random)},
                      std::pow(10, 6 * u(random) - 4),
                      n % 3 == 0 ? 0 : 0.2 * t * u(random)});
    }
  }
  return out;
}

void expect_same(const GasSpectrum& is, const GasSpectrum& should, double& worst) {
  const auto near = [&](double a, double b, double floor) {
    const double off = std::abs(a - b) / (std::abs(b) + floor);
    worst = std::max(worst, off);
    return off < 1e-10;
  };
  for (std::size_t b = 0; b < should.bands.size(); ++b) {
    ASSERT_NEAR(is.transmittance[b], should.transmittance[b], 1e-11) << b;
    ASSERT_PRED3(near, is.absorptance[b], should.absorptance[b], 1e-270) << b;
    ASSERT_PRED3(near, is.radiance_w_m2_sr_um[b], should.radiance_w_m2_sr_um[b], 1e-270) << b;
  }
}

TEST(GasPath, Alone) {
  double worst = 0;
  for (const std::vector<GasLayer>& path : paths()) {
    const auto is = gas_spectrum(path), should = plain::gas_spectrum(path);
    ASSERT_TRUE(is.ok() && should.ok());
    expect_same(*is, *should, worst);
  }
  std::printf("largest difference %.2g\n", worst);
}

TEST(GasPath, ThroughAir) {
  double worst = 0;
  AtmosphereSpec spec{afgl_profile(AfglProfile::kTropical), {}, 425, 0, 0};
  const Atmosphere air = *Atmosphere::make(spec);
  std::vector<AbsorberAmounts> amounts = {AbsorberAmounts()};
  for (const double range_m : {1e-3, 100.0, 5e3, 1e5})
    amounts.push_back(air.amounts(level_path(10, range_m)));
  for (const AbsorberAmounts& of : amounts)
    for (const std::vector<GasLayer>& path : paths()) {
      const auto is = gas_through_air(path, of), should = plain::gas_through_air(path, of);
      ASSERT_TRUE(is.ok() && should.ok());
      expect_same(is->spectrum, should->spectrum, worst);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        ASSERT_NEAR(is->air_transmittance[b], should->air_transmittance[b], 1e-12);
        ASSERT_NEAR(is->water_correlation_error_w_m2_sr_um[b],
                    should->water_correlation_error_w_m2_sr_um[b],
                    1e-9 * should->water_correlation_error_w_m2_sr_um[b] +
                        1e-11 * should->spectrum.radiance_w_m2_sr_um[b] + 1e-270)
            << b;
      }
    }
  std::printf("largest difference %.2g\n", worst);
}

// A range of bands is a part of all.
TEST(GasPath, Ranges) {
  const std::vector<std::vector<GasLayer>> all = paths();
  const AbsorberAmounts air =
      Atmosphere::make({afgl_profile(AfglProfile::kTropical), {}, 425, 0, 0})
          ->amounts(level_path(10, 1000));
  for (std::size_t n = 7; n < all.size(); n += 9) {
    const auto whole = gas_through_air(all[n], air);
    for (const GasBands bands : {GasBands{60, 61}, GasBands{199, 245}, GasBands{300, 335}}) {
      const auto part = gas_through_air(all[n], air, bands);
      ASSERT_TRUE(part.ok() && whole.ok());
      for (std::size_t b = bands.first; b < bands.last; ++b)
        EXPECT_EQ(part->spectrum.radiance_w_m2_sr_um[b - bands.first],
                  whole->spectrum.radiance_w_m2_sr_um[b - kAirGasBands.first]);
    }
  }
}

}  // namespace
}  // namespace irsig
