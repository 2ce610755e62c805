// Rationale: of hot water's light the air takes more than of grey light, the more the colder the
// gas is. Expected: between the product of band means and common ranks of absorption, as line by
// line says. Source: values/gas_hot_water_through_air.csv.
#include <gtest/gtest.h>

#include <cmath>

#include "core/atmosphere/atmosphere.h"
#include "core/gas/gas_spectrum.h"
#include "core/gas/water_through_air.h"
#include "tests/physics/reference_table.h"

namespace irsig {
namespace {

// Air of 288 K with 1.4 % of water.
Atmosphere humid_air() {
  AirProfile profile = afgl_profile(AfglProfile::kUsStandard1976);
  for (AirLevel& l : profile.level) {
    if (l.height_m < 500) l.gas.h2o_ppmv = 14000;
  }
  AtmosphereSpec spec{profile, {}, 425, 0, 0};
  spec.aerosol.kind = AerosolKind::kNone;
  return *Atmosphere::make(spec);
}

TEST(GasAir, HotWaterThroughHumidAir) {
  const ReferenceTable table("gas_hot_water_through_air.csv");
  const Atmosphere air = humid_air();
  double squares = 0;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const double t = table.number(row, "temperature_k"), u = table.number(row, "u_cm_atm");
    const AbsorberAmounts amounts =
        air.amounts(level_path(0, 1000 * table.number(row, "range_km")));
    const std::vector<GasLayer> path = {{{t, 101325, 0.1, 0, 0, 0}, u / 0.1 / 100}};
    const GasBands bands = {195, 205};
    const auto ours = gas_through_air(path, amounts, bands);
    const auto alone = gas_spectrum(path, bands);
    ASSERT_TRUE(ours.ok() && alone.ok());
    double sum = 0, product = 0, spread = 0, sent = 0;
    for (std::size_t b = 0; b < bands.size(); ++b) {
      // The comparison is of the lines alone: continuum and other gases are factors.
      const std::size_t band = bands.first + b - kAirGasBands.first;
      const double factors = ours->air_transmittance[b] / transmittance(amounts, Gas::kH2o)[band];
      sum += ours->spectrum.radiance_w_m2_sr_um[b] / factors;
      spread += ours->water_correlation_error_w_m2_sr_um[b] / factors;
      sent += alone->radiance_w_m2_sr_um[b];
      product += alone->radiance_w_m2_sr_um[b] * transmittance(amounts, Gas::kH2o)[band];
    }
    const double exact = 1 / table.number(row, "product_over_exact");
    const double ranked = table.number(row, "ranked_over_exact") * exact;
    std::printf(
        "%4.0f K %4.1f cm atm %4.1f km: of the product ours %.3f +- %.3f, exact %.3f (ranked "
        "%.3f), T %.3f\n",
        t, u, table.number(row, "range_km"), sum / product, spread / product, exact, ranked,
        product / sent);
    // Products of means are wrong by factors of 1.3 to 12.
    EXPECT_NEAR(sum / product, exact, 0.16);
    EXPECT_GT(sum / product, ranked * 0.8);
    EXPECT_LT(sum, product);
    const double z = (sum / product - exact) / (spread / product);
    EXPECT_LT(std::abs(z), 3);
    squares += z * z;
  }
  const double rms = std::sqrt(squares / static_cast<double>(table.size()));
  std::printf("difference over the stated sigma: rms %.2f\n", rms);
  EXPECT_GT(rms, 0.4);
  EXPECT_LT(rms, 1.4);
}

// The distribution whose transform is Malkmus' band: by its closed form.
TEST(GasAir, ShareOfAbsorptionIsMalkmus) {
  for (const double shape : {0.01, 0.3, 2.0, 20.0}) {
    for (const double depth : {0.05, 1.0, 8.0}) {
      double sum = 0, last = 0;
      constexpr int kCells = 4000;
      for (int i = 1; i <= kCells; ++i) {
        // Cells that shrink towards 1, where the strong wavenumbers are.
        const auto share = [](double x) { return 1 - std::pow(1 - x / kCells, 4); };
        const double w = share(i) - share(i - 1.0);
        const double next = inverse_gaussian_lorenz(share(i), shape);
        sum += w * std::exp(-depth * (next - last) / w);
        last = next;
      }
      const double a = shape / 2;  // X of the whole, a: T = exp(-2 a (sqrt(1 + X / a) - 1))
      EXPECT_NEAR(sum, std::exp(-2 * a * (std::sqrt(1 + depth / a) - 1)), 0.004)
          << shape << ' ' << depth;
    }
  }
}

// Without air nothing changes, with air nothing exceeds the gas's own light; grey light is a
// product.
TEST(GasAir, Limits) {
  const std::vector<GasLayer> path = {{{300, 101325, 0.05, 0.05, 0.001, 1e-8}, 0.5},
                                      {{900, 101325, 0.1, 0.08, 0.002, 1e-7}, 1}};
  const auto alone = gas_spectrum(path, kAirGasBands);
  const auto none = gas_through_air(path, AbsorberAmounts());
  const AbsorberAmounts amounts = humid_air().amounts(level_path(0, 3000));
  const auto behind = gas_through_air(path, amounts);
  ASSERT_TRUE(alone.ok() && none.ok() && behind.ok());
  const AirSpectrum air = transmittance(amounts);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    EXPECT_NEAR(none->spectrum.radiance_w_m2_sr_um[b], alone->radiance_w_m2_sr_um[b],
                1e-9 * alone->radiance_w_m2_sr_um[b]);
    EXPECT_NEAR(none->spectrum.transmittance[b], alone->transmittance[b], 1e-12);
    EXPECT_NEAR(behind->air_transmittance[b], air[b], 1e-9);
    EXPECT_LE(behind->spectrum.radiance_w_m2_sr_um[b], alone->radiance_w_m2_sr_um[b]);
    EXPECT_LE(behind->spectrum.transmittance[b], air[b] * (1 + 1e-9));
    EXPECT_NEAR(behind->air_transmittance[b] - behind->spectrum.transmittance[b],
                behind->spectrum.absorptance[b], 1e-9);
  }
  const std::vector<GasLayer> soot = {{{900, 101325, 0, 0, 0, 1e-7}, 1}};
  const auto grey = gas_through_air(soot, amounts);
  const auto grey_alone = gas_spectrum(soot, kAirGasBands);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    EXPECT_NEAR(grey->spectrum.radiance_w_m2_sr_um[b], grey_alone->radiance_w_m2_sr_um[b] * air[b],
                1e-9 * grey_alone->radiance_w_m2_sr_um[b]);
  }
  EXPECT_FALSE(gas_through_air(path, amounts, {59, 70}).ok());
  EXPECT_FALSE(gas_through_air(path, amounts, {300, 336}).ok());
}

}  // namespace
}  // namespace irsig
