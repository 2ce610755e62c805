// Emissivities that change within a step of a band, against an integral in steps of 1e-6 of the
// band.

#include <random>

#include "core/materials/spectra.h"
#include "core/spectral/planck.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kTemperatureK = 310;

// Mean emissivity of a flat disk, weighted by what it emits in the band.
double expected_emissivity(const Spectrum& table, const Band& band) {
  double emitted = 0, black = 0;
  constexpr int kSteps = 1000000;
  for (int i = 0; i < kSteps; ++i) {
    const double um =
        band.lambda_min_um + (i + 0.5) / kSteps * (band.lambda_max_um - band.lambda_min_um);
    const double radiance = planck_radiance_w_m2_sr_um(um, kTemperatureK);
    emitted += spectrum_at(table, um) * radiance;
    black += radiance;
  }
  return emitted / black;
}

struct Measured {
  double emissivity, error, quadrature;
};
Measured measured(const Spectrum& table, const Band& band) {
  const auto simulator =
      simulator_of(scene_of(generated("disk", 100), {"m", Lambert{table}}, band));
  const SignatureResult s = only_row(*simulator, request(*simulator, 0, 60, 1e4, {kTemperatureK}));
  const double black =
      s.projected_area_m2.value *
      planck_band_radiance_w_m2_sr(band.lambda_min_um, band.lambda_max_um, kTemperatureK);
  // The silhouette is that of both numbers: what is left is the quadrature alone.
  return {s.intensity_w_sr.value / black, s.quadrature_bound_w_sr / black,
          s.quadrature_bound_w_sr / s.intensity_w_sr.value};
}

TEST(NarrowTable, ANotchBetweenTheStoredWavelengths) {
  const Spectrum notch{{2.5, 0.9}, {4.02, 0.9}, {4.03, 0.1}, {4.06, 0.1}, {4.061, 0.9}, {5.5, 0.9}};
  for (const double step_um : {0.5, 0.25, 0.05}) {
    const Band band{"b", 3, 5, step_um, {}};
    const Measured m = measured(notch, band);
    EXPECT_NEAR(m.emissivity, expected_emissivity(notch, band), 3e-7 + m.error) << step_um;
    EXPECT_LT(m.quadrature, 1e-4) << step_um;
  }
}

// A spectrometer's table: more points than wavelengths that anybody wants to compute, and noise.
TEST(NarrowTable, ANoisyTableIsThinnedAndBounded) {
  std::mt19937 dice(7);
  std::uniform_real_distribution<double> noise(-0.01, 0.01);
  Spectrum table;
  for (int i = 0; i <= 20000; ++i) table.push_back({2.5 + 3.0 * i / 20000, 0.6 + noise(dice)});
  const Band band{"b", 3, 5, 0.25, {}};
  const auto scene = scene_of(generated("disk", 100), {"m", Lambert{table}}, band);
  EXPECT_LE(simulator_of(scene)->band_grids().front().node_um.size(), 2u * (512 + 40));
  const Measured m = measured(table, band);
  EXPECT_LE(std::abs(m.emissivity - expected_emissivity(table, band)), m.error);
  EXPECT_LT(m.quadrature, 0.3);
}

TEST(NarrowTable, StraightLinesHaveNoCorners) {
  Spectrum line;
  for (int i = 0; i <= 100; ++i) line.push_back({2.0 + 0.05 * i, 0.2 + 0.001 * i});
  const TableCorners none = table_corners({"m", Lambert{line}}, 3, 5, 1e-5);
  EXPECT_TRUE(none.um.empty());
  EXPECT_LT(none.left_out, 1e-12);
  line[50].value += 0.1;  // 4.5 um
  const TableCorners bent = table_corners({"m", Lambert{line}}, 3, 5, 1e-5);
  ASSERT_EQ(bent.um.size(), 3u);
  EXPECT_DOUBLE_EQ(bent.um[1], 4.5);
  // Points outside of the band do not matter.
  EXPECT_TRUE(table_corners({"m", Lambert{line}}, 2.5, 4, 1e-5).um.empty());
}

}  // namespace
}  // namespace irsig
