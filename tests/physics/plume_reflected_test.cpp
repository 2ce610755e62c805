// Rationale: hot gas that the target reflects, and what gas takes of other light on its way to the
// target.
// Expected: a small plate before a slab of gas reflects what columns over its hemisphere add up to,
// and loses of the sun behind the gas what one column takes; gas of the temperature of all around
// changes nothing; what is left out is within its bound; other seeds scatter as is stated.
// Source: closed forms; column spectra of core/gas (tests/physics/gas_test.cpp).
#include <cmath>
#include <numbers>

#include "core/spectral/solar.h"
#include "tests/physics/plume_view_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kReflectance = 0.6, kViewDeg = 60, kRadiusM = 0.01;

// A small matt plate that faces ahead; from its side no gas before it is in sight.
std::unique_ptr<Simulator> plate(MaterialSpec material) {
  SceneSpec scene = scene_of(generated("disk", 200, kRadiusM), std::move(material), mwir());
  scene.band.push_back({"LWIR", 8, 12, 0.25, {}});
  scene.spectral_breaks_um = gas_band_edges_um(3, 12);
  return simulator_of(scene);
}

ViewRequest seen_from_the_side(const Simulator& simulator, double target_k) {
  ViewRequest r = request(simulator, kViewDeg, 0, 1e4, {target_k});
  r.max_reflections = 1;
  r.accuracy.samples_per_replicate = 2048;
  return r;
}

const LedgerEntry& entry(const SignatureResult& row, Effect effect) {
  for (const LedgerEntry& e : row.effect)
    if (e.effect == effect) return e;
  ADD_FAILURE() << "no " << info_of(effect).name;
  return row.effect.front();
}

double plate_m2() {
  return kRadiusM * kRadiusM * 0.5 * 200 * std::sin(2 * std::numbers::pi / 200) *
         std::cos(kViewDeg * std::numbers::pi / 180);
}

// Returns the reflected part of the gas's irradiance of the plate, column by column over its
// hemisphere. [band] [W/m2]
template <typename Reflectance>
std::array<double, 2> reflected(const Simulator& simulator, const PlumeField& field,
                                const Reflectance& reflectance) {
  const std::vector<double> um = nodes_of(simulator);
  const auto wavelengths = GasWavelengths::make(um);
  EXPECT_TRUE(wavelengths.ok());
  std::array<double, 2> out{};
  constexpr int kRings = 40, kAzimuths = 48;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kAzimuths; ++j) {
      const double sin2 = (i + 0.5) / kRings,
                   azimuth = 2 * std::numbers::pi * (j + 0.5) / kAzimuths;
      const double s = std::sqrt(sin2);
      const GasColumn column = march(
          field,
          {{0, 0, 0}, {std::sqrt(1 - sin2), s * std::cos(azimuth), s * std::sin(azimuth)}, 0, 1e3},
          SegmentSteps());
      if (column.empty()) continue;
      const auto hot = HotColumn::make(column, *wavelengths);
      EXPECT_TRUE(hot.ok()) << hot.status();
      std::vector<double> light = hot->at_near_end().emitted_w_m2_sr_um;
      for (std::size_t k = 0; k < um.size(); ++k) light[k] *= reflectance(um[k]);
      for (std::size_t b = 0; b < 2; ++b)
        out[b] += std::numbers::pi / (kRings * kAzimuths) * in_band_of(simulator, b, light);
    }
  return out;
}

TEST(PlumeOnHull, APlateReflectsTheColumnsOverIt) {
  const auto simulator = plate(grey(1 - kReflectance));
  ViewRequest r = seen_from_the_side(*simulator, 300);
  r.condition[0].gas = slab(3);
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  const auto expected =
      reflected(*simulator, *r.condition[0].gas, [](double) { return kReflectance; });
  for (std::size_t b = 0; b < 2; ++b) {
    const SignatureResult& row = view->row[b];
    // The lattice of directions: the slab's edges. Not the row's bound: most of that is of the slab
    // in sight.
    expect_within_t(row.plume_reflected_w_sr, plate_m2() / std::numbers::pi * expected[b], 4,
                    "plate", 0.01, 0.003 * row.plume_reflected_w_sr.value);
    EXPECT_LT(row.plume_bound_w_sr, 0.02 * row.plume_emitted_w_sr);
    // The row's gas is this and what is seen of the slab itself, off to the side.
    EXPECT_NEAR(row.plume_w_sr.value - row.plume_reflected_w_sr.value, row.plume_emitted_w_sr,
                1e-6 * row.plume_emitted_w_sr);
    const LedgerEntry& hull = entry(row, Effect::kPlumeOnHull);
    EXPECT_EQ(hull.fraction_w_sr, row.plume_reflected_w_sr.value);
    EXPECT_GE(hull.bound_w_sr,
              row.plume_reflected_w_sr.value + 3.99 * row.plume_reflected_w_sr.stderr_);
    // No air, and nothing behind.
    for (const Estimate& same : {row.apparent_plume_w_sr, row.contrast_plume_w_sr})
      EXPECT_NEAR(same.value, row.plume_w_sr.value, 1e-9 * row.plume_w_sr.value);
    EXPECT_EQ(entry(row, Effect::kPlume).fraction_w_sr, row.plume_w_sr.value);
    EXPECT_EQ(entry(row, Effect::kPlume).reason, EffectReason::kNotAsked);
  }
}

// The gas stands before a hundredth of a large target, which alone reflects it: few rays know what
// is reflected, as they are aimed there: 0.14, 0.11. Spread evenly: 0.27, 0.25.
TEST(PlumeOnHull, FewRaysFindTheFewFacetsBesideTheGas) {
  SceneSpec scene = scene_of(generated("disk", 20000, 60), grey(1 - kReflectance), mwir());
  scene.spectral_breaks_um = gas_band_edges_um(3, 12);
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, kViewDeg, 0, 1e4, {300});
  r.max_reflections = 1;
  r.condition[0].gas = slab(3, kGasK, 40);
  const auto found = [&](std::uint64_t seed, std::uint64_t samples) {
    r.seed = seed;
    r.accuracy.samples_per_replicate = samples;
    const auto view = simulator->simulate(r);
    EXPECT_TRUE(view.ok()) << view.status();
    return view->row[0].plume_reflected_w_sr;
  };
  const Estimate much = found(1, 4096);
  double scatter = 0, stated = 0;
  for (std::uint64_t seed = 2; seed <= 7; ++seed) {
    const Estimate few = found(seed, 64);
    scatter += std::pow(few.value / much.value - 1, 2) / 6;
    stated += std::pow(few.stderr_ / much.value, 2) / 6;
  }
  std::printf("off by %.3f, stated %.3f\n", std::sqrt(scatter), std::sqrt(stated));
  EXPECT_LT(std::sqrt(scatter), 0.2);
  EXPECT_LT(std::sqrt(stated), 0.15);
}

// A painted plate: each wavelength by its own reflectance.
TEST(PlumeOnHull, ReflectionsAreSpectral) {
  const auto reflectance = [](double um) { return um < 4.2 ? 0.2 : um < 6 ? 0.7 : 0.4; };
  const auto simulator =
      plate({"paint",
             Lambert{{{2.8, 0.8}, {4.199, 0.8}, {4.2, 0.3}, {6, 0.3}, {6.001, 0.6}, {13, 0.6}}}});
  ViewRequest r = seen_from_the_side(*simulator, 300);
  r.condition[0].gas = slab(3);
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  const auto expected = reflected(*simulator, *r.condition[0].gas, reflectance);
  for (std::size_t b = 0; b < 2; ++b)
    expect_within_t(view->row[b].plume_reflected_w_sr, plate_m2() / std::numbers::pi * expected[b],
                    2, "painted plate", 0.01, 0.003 * view->row[b].plume_reflected_w_sr.value);
}

// The sun ahead shines on the plate through the slab.
TEST(PlumeOnHull, TheSunLosesWhatAColumnTakes) {
  const auto simulator = plate(grey(1 - kReflectance));
  ViewRequest r = seen_from_the_side(*simulator, 300);
  r.condition[0].sun = true;
  r.condition[0].sun_direction = normalized(Vec<Body>{1, 0, -0.3});
  r.condition[0].sun_cos_zenith = -r.condition[0].sun_direction.z;
  r.condition[0].sun_scale = 1;
  r.condition[0].gas = slab(3, 300);
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  const SignatureResult& row = view->row[0];
  const double sent =
      plate_m2() / std::numbers::pi *
      reflected(*simulator, *r.condition[0].gas, [](double) { return kReflectance; })[0];
  GasLayer slanted = slab_layer(300);
  slanted.length_m /= r.condition[0].sun_direction.x;
  const Column column = column_of(*simulator, slanted, nullptr);
  const std::vector<double> um = nodes_of(*simulator);
  std::vector<double> sun, taken;
  for (std::size_t i = 0; i < um.size(); ++i) {
    sun.push_back(solar_irradiance_w_m2_um(um[i]));
    taken.push_back(column.absorbed[i] * sun.back());
  }
  const double share = in_band_of(*simulator, 0, taken) / in_band_of(*simulator, 0, sun);
  const double lost = share * row.cause_w_sr[static_cast<std::size_t>(Cause::kSunReflected)].value;
  EXPECT_GT(lost, 3 * sent);
  expect_within_t(row.plume_reflected_w_sr, sent - lost, 1, "plate in the sun", 0.02, 0.005 * lost);
}

// All of one temperature: whatever gas sends it takes of what is behind it.
TEST(PlumeOnHull, InAWorldOfOneTemperatureNothingChanges) {
  const auto simulator = plate(grey(1 - kReflectance));
  ViewRequest r = seen_from_the_side(*simulator, kGasK);
  ConditionSpec& c = r.condition[0];
  c.gas = slab(3);
  c.surroundings.kind = SurroundingsKind::kSea;
  c.surroundings.sky_temperature_k = c.surroundings.sea_temperature_k = kGasK;
  c.surroundings.sea_emissivity = 1;
  const auto hot = simulator->simulate(r);
  c.surroundings.sky_temperature_k = c.surroundings.sea_temperature_k = 3;
  const auto cold = simulator->simulate(r);
  ASSERT_TRUE(hot.ok() && cold.ok());
  for (std::size_t b = 0; b < 2; ++b) {
    const double sent = cold->row[b].plume_reflected_w_sr.value;
    const Estimate& left = hot->row[b].plume_reflected_w_sr;
    EXPECT_GT(sent, 0);
    EXPECT_LT(std::abs(left.value), 0.12 * sent + 4 * left.stderr_);
    EXPECT_LT(std::abs(left.value), hot->row[b].plume_bound_w_sr + 4 * left.stderr_);
  }
}

// Light that is left out, by the program or by the user, is within its bound, and the bound not far
// above it.
TEST(PlumeOnHull, WhatIsLeftOutIsBounded) {
  const auto simulator = plate(grey(1 - kReflectance));
  ViewRequest r = seen_from_the_side(*simulator, 300);
  r.condition[0].gas = slab(3);
  const auto with = simulator->simulate(r);
  ASSERT_TRUE(with.ok()) << with.status();
  for (const bool all : {false, true}) {
    r.effects.without_plume = {all ? Effect::kPlume : Effect::kPlumeOnHull};
    const auto without = simulator->simulate(r);
    ASSERT_TRUE(without.ok()) << without.status();
    for (std::size_t b = 0; b < 2; ++b) {
      const SignatureResult &row = without->row[b], &full = with->row[b];
      const double off = std::abs(full.intensity_w_sr.value - row.intensity_w_sr.value);
      EXPECT_LE(off, row.omitted_bound_w_sr);
      EXPECT_GT(off, 0.5 * row.omitted_bound_w_sr);
      EXPECT_EQ(row.plume_reflected_w_sr.value, 0);
      EXPECT_GE(row.numerical_error_w_sr, 0.5 * off);
      const LedgerEntry& e = entry(row, r.effects.without_plume.front());
      EXPECT_EQ(e.state, EffectState::kOff);
      EXPECT_EQ(e.reason, EffectReason::kForced);
      EXPECT_EQ(row.plume_w_sr.value == 0, all);
    }
  }
}

// A wide target hides the gas's reflection in a small plate; the goal decides.
TEST(PlumeOnHull, WhereItHardlyMattersItIsLeftOut) {
  for (const bool hot : {false, true}) {
    const auto simulator = plate(grey(1 - kReflectance));
    ViewRequest r = seen_from_the_side(*simulator, hot ? 300 : 1500);
    r.condition[0].gas = slab(3, hot ? kGasK : 400);
    r.accuracy = AccuracySpec{};
    r.accuracy.relative_error = 0.01;
    r.effects.mode = EffectChoice::Mode::kAuto;
    const auto view = simulator->simulate(r);
    ASSERT_TRUE(view.ok()) << view.status();
    for (const SignatureResult& row : view->row) {
      const LedgerEntry& e = entry(row, Effect::kPlumeOnHull);
      EXPECT_EQ(e.state, hot ? EffectState::kOn : EffectState::kOff) << row.band;
      EXPECT_EQ(e.reason, hot ? EffectReason::kAboveShare : EffectReason::kWithinShare) << row.band;
      EXPECT_EQ(row.plume_reflected_w_sr.value > 0, hot);
      EXPECT_EQ(row.omitted_bound_w_sr > 0, !hot);
    }
  }
}

// Behind the plate no reflection meets the gas: as much may be as so many rays would have missed.
TEST(PlumeOnHull, WhatNoRayHasMetIsBounded) {
  const auto simulator = plate(grey(1 - kReflectance));
  ViewRequest r = seen_from_the_side(*simulator, 300);
  r.condition[0].gas = slab(-3);
  std::vector<double> bound;
  for (const std::uint64_t samples : {512, 4096}) {
    r.accuracy.samples_per_replicate = samples;
    const auto view = simulator->simulate(r);
    ASSERT_TRUE(view.ok()) << view.status();
    const SignatureResult& row = view->row[0];
    EXPECT_EQ(row.plume_reflected_w_sr.value, 0);
    EXPECT_EQ(entry(row, Effect::kPlumeOnHull).state, EffectState::kOn);
    bound.push_back(row.omitted_bound_w_sr);
  }
  EXPECT_GT(bound[1], 0);
  EXPECT_NEAR(bound[0] / bound[1], 8, 1e-6);
  // The least density of rays on the plate is three tenths of an even one. Three rays of four
  // reflections each may have missed gas as hot and black as any; cells cover more than the plate.
  std::vector<double> hottest;
  for (const double um : nodes_of(*simulator))
    hottest.push_back(planck_radiance_w_m2_sr_um(um, kGasK));
  const double most =
      3 * plate_m2() / (4 * 0.3 * 512 * r.accuracy.replicates) * in_band_of(*simulator, 0, hottest);
  EXPECT_GT(bound[0], most);
  EXPECT_LT(bound[0], 1.5 * most);
}

TEST(PlumeOnHull, SeedsScatterAsTheyState) {
  const auto simulator = plate(grey(1 - kReflectance));
  ViewRequest r = seen_from_the_side(*simulator, 300);
  r.condition[0].gas = slab(3);
  r.accuracy.samples_per_replicate = 64;
  expect_seeds_scatter_as_stated(*simulator, r, &SignatureResult::plume_reflected_w_sr);
}

}  // namespace
}  // namespace irsig
