// Rationale: a cloud is left out of rows where the most that it can change fits into their error,
// and is in their ledger wherever there is one.
// Expected: bounds of the ledger hold against rows under a clear sky on the same paths, for broken
// and overcast skies, by day and night; a hot body under a cloud has the rows of the clear sky,
// bit by bit, with the bound in its error; a line of sight that reaches the cloud has no bound.
// In twilight sunlight that the air scatters is left, and none of the disk.
// Source: the same program with and without the cloud, and without a sun.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/accuracy/replicates.h"
#include "core/environment/environment.h"
#include "core/signature/effect_bounds.h"
#include "tests/physics/plume_view_fixture.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

const CloudSpec kDeck = {CloudPhase::kWater, 330, 1000, 0.201, 7.9};

struct Under {
  double cover;
  bool sun;
  CloudSpec cloud = kDeck;
  std::optional<std::array<double, 2>> base_range_m = std::nullopt;
  Vec<Body> sun_direction = normalized(Vec<Body>{0.3, 0.5, -0.8});
};

struct CloudyScene {
  std::shared_ptr<const Simulator> simulator;
  ViewRequest request;
};

// A body over a rough sea, one condition for each sky.
CloudyScene body_under(const std::vector<Under>& skies, const Mesh& mesh, double kelvin,
                       double elevation_deg, double range_m, double relative_error) {
  SceneSpec spec = scene_of(mesh, grey(0.9), lwir());
  spec.band.push_back({"MWIR", 3.2, 5, 0.25, {}});
  spec.spectral_breaks_um = air_band_edges_um(3, 13);
  CloudyScene out{simulator_of(spec), {}};
  out.request = request(*out.simulator, 70, elevation_deg, range_m, {kelvin});
  out.request.max_reflections = 8;
  out.request.accuracy.samples_per_replicate = 0;
  out.request.accuracy.relative_error = relative_error;
  out.request.effects.mode = EffectChoice::Mode::kAuto;
  out.request.condition.assign(skies.size(), out.request.condition[0]);
  out.request.selected_condition.clear();
  std::vector<WeatherSpec> weathers;
  std::vector<ConditionEnvironment> conditions;
  for (std::uint32_t i = 0; i < skies.size(); ++i) {
    WeatherSpec& w = weathers.emplace_back(
        WeatherSpec{{afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kMaritime, 23e3}},
                    true,
                    {SurfaceBoundary::Kind::kRoughSea, 291, 1, 5},
                    nullptr});
    w.cloud_cover = skies[i].cover;
    if (w.cloud_cover > 0) w.cloud = skies[i].cloud;
    w.cloud_base_range_m = skies[i].base_range_m;
    ConditionSpec& c = out.request.condition[i];
    c.surroundings.kind = SurroundingsKind::kSea;
    c.sea_wind_m_s = w.lower.wind_speed_m_s;
    c.sun = skies[i].sun;
    c.sun_direction = skies[i].sun_direction;
    c.sun_cos_zenith = -c.sun_direction.z;
    c.sun_angular_radius_deg = 0.266;
    c.sun_scale = 1;
    conditions.push_back({i, c.sun, c.sun_direction, 1});
    out.request.selected_condition.push_back(i);
  }
  std::vector<double> node_um;
  for (const BandGrid& grid : out.simulator->band_grids())
    node_um.insert(node_um.end(), grid.node_um.begin(), grid.node_um.end());
  auto made = Environment::make(weathers, conditions, 6, node_um);
  EXPECT_TRUE(made.ok()) << made.status();
  out.request.environment = *std::move(made);
  return out;
}

Mesh hot_box() { return generated("box", 12, 0, 20, 20, 10); }

ViewPlan planned(const CloudyScene& s) {
  auto plan = s.simulator->plan(s.request);
  EXPECT_TRUE(plan.ok()) << plan.status();
  return *std::move(plan);
}
ViewResult measured(const CloudyScene& s, const ViewPlan& plan) {
  auto view = s.simulator->measure(s.request, plan);
  EXPECT_TRUE(view.ok()) << view.status();
  return *std::move(view);
}

const LedgerEntry* cloud_of(const std::vector<LedgerEntry>& ledger) {
  const auto at = std::find_if(ledger.begin(), ledger.end(),
                               [](const LedgerEntry& e) { return is_of_cloud(e.effect); });
  return at == ledger.end() ? nullptr : &*at;
}

Estimate difference(const std::vector<double>& a, const std::vector<double>& b) {
  ReplicateStatistics sum(1);
  for (std::size_t r = 0; r < a.size(); ++r) sum.add(std::array{a[r] - b[r]});
  return sum.estimate(0);
}

// Expected: each change that a cloud makes is within the ledger's bound of it. Bounds of a broken
// sky are that of an overcast one times the cover, or the standard deviation of which of both a
// target has, where that is larger.
TEST(CloudEffect, BoundsOfTheLedgerHold) {
  double tightest = 0;
  for (const bool sun : {false, true})
    for (const auto& [elevation_deg, range_m] : {std::pair{2.0, 2000.0}, {10.0, 500.0}}) {
      const CloudyScene s =
          body_under({{0, sun}, {1, sun}, {0.3, sun}, {0.02, sun}}, generated("frigate", 2000), 300,
                     elevation_deg, range_m, 0.02);
      const ViewResult view = measured(s, planned(s));
      for (const SignatureResult& row : view.row) {
        const LedgerEntry* cloud = cloud_of(row.effect);
        ASSERT_EQ(cloud != nullptr, row.condition > 0);
        if (cloud == nullptr) continue;
        EXPECT_EQ(cloud->state, EffectState::kOn);
        EXPECT_EQ(cloud->reason, EffectReason::kAboveShare);
        const double cover = std::array{0.0, 1.0, 0.3, 0.02}[row.condition];
        const LedgerEntry& overcast = *cloud_of(view.row[2 + row.band].effect);
        EXPECT_NEAR(cloud->contrast_bound_w_sr / overcast.contrast_bound_w_sr,
                    std::max(cover, std::sqrt(cover * (1 - cover))), 1e-9);
        const SignatureResult& clear = view.row[row.band];
        ASSERT_EQ(clear.condition, 0U);
        ASSERT_EQ(clear.band, row.band);
        const auto within = [&](const char* what, const std::vector<double>& a,
                                const std::vector<double>& b, double bound) {
          const Estimate d = difference(a, b);
          EXPECT_LE(std::abs(d.value), bound + 4 * d.stderr_) << what << " " << row.condition;
          tightest = std::max(tightest, std::abs(d.value) / bound);
        };
        within("source", row.replicate_w_sr, clear.replicate_w_sr, cloud->bound_w_sr);
        within("apparent", row.replicate_apparent_w_sr, clear.replicate_apparent_w_sr,
               cloud->apparent_bound_w_sr);
        within("contrast", row.replicate_contrast_w_sr, clear.replicate_contrast_w_sr,
               cloud->contrast_bound_w_sr);
      }
    }
  RecordProperty("tightest", std::to_string(tightest));
  EXPECT_GT(tightest, 0.02);
}

// Expected: the clear sky's light by way of the target, to the last bit, and the bound in the
// error; behind the target what a sensor sees under the cloud.
TEST(CloudEffect, IsLeftOutWhereTheTargetOutshinesTheSky) {
  for (const bool sun : {false, true}) {
    const CloudyScene s =
        body_under({{0, sun}, {1, sun}, {0.4, sun}}, hot_box(), 1200, 3, 1000, 0.05);
    const ViewPlan plan = planned(s);
    CloudyScene all = s;
    all.request.effects.mode = EffectChoice::Mode::kAll;
    ViewPlan everything = planned(all);
    everything.samples_per_replicate = plan.samples_per_replicate;
    const ViewResult view = measured(s, plan), truth = measured(all, everything);
    ASSERT_EQ(view.row.size(), 6U);
    for (std::size_t i = 0; i < view.row.size(); ++i) {
      const SignatureResult &row = view.row[i], &clear = view.row[row.band];
      const LedgerEntry* cloud = cloud_of(row.effect);
      ASSERT_EQ(cloud != nullptr, row.condition > 0);
      if (cloud == nullptr) continue;
      EXPECT_EQ(cloud->state, EffectState::kOff) << row.condition << " " << row.band;
      EXPECT_EQ(cloud->reason, EffectReason::kWithinShare);
      EXPECT_EQ(row.replicate_w_sr, clear.replicate_w_sr);
      EXPECT_EQ(row.replicate_apparent_w_sr, clear.replicate_apparent_w_sr);
      // The background has its cloud, and by day its sunlight.
      const double behind = row.background_radiance_w_m2_sr.value,
                   with_cloud = truth.row[i].background_radiance_w_m2_sr.value;
      EXPECT_NEAR(behind, with_cloud, 1e-4 * with_cloud) << row.condition << " " << row.band;
      EXPECT_GT(std::abs(behind - clear.background_radiance_w_m2_sr.value), 2e-3 * with_cloud);
      EXPECT_GE(row.contrast_omitted_bound_w_sr, cloud->contrast_bound_w_sr);
      EXPECT_GT(cloud->contrast_bound_w_sr, 0);
      const Estimate d =
          difference(row.replicate_contrast_w_sr, truth.row[i].replicate_contrast_w_sr);
      EXPECT_LE(std::abs(d.value), row.contrast_omitted_bound_w_sr + 4 * d.stderr_);
      EXPECT_GT(std::abs(d.value), 0);
      EXPECT_EQ(row.stop_reason, StopReason::kTargetReached);
    }
  }
}

// A sensor above the base, a fog on the ground, and a base that may lie below the sensor.
TEST(CloudEffect, HasNoBoundWhereTheLineOfSightReachesTheCloud) {
  const CloudSpec fog = {CloudPhase::kWater, 0, 300, 0.003, 8};
  const auto expect_unbounded = [](const CloudyScene& s) {
    const ViewPlan plan = planned(s);
    for (const std::size_t row : {0, 1}) {
      const LedgerEntry* entry = cloud_of(plan.ledger[row]);
      ASSERT_NE(entry, nullptr);
      EXPECT_EQ(entry->state, EffectState::kOn);
      EXPECT_EQ(entry->reason, EffectReason::kUnbounded);
      EXPECT_TRUE(std::isnan(entry->contrast_bound_w_sr));
      EXPECT_EQ(cloud_of(plan.ledger[2 + row]), nullptr);
    }
  };
  const auto seen = [](const Under& sky, double elevation_deg) {
    return body_under({sky, {0, false}}, hot_box(), 1200, elevation_deg, 1000, 0.05);
  };
  expect_unbounded(seen({1, false}, 30));
  expect_unbounded(seen({1, false, fog}, 3));
  expect_unbounded(seen({1, false, kDeck, {{40, 2500}}}, 3));
  // An image shows its sky.
  CloudyScene image = seen({1, false}, 3);
  EXPECT_EQ(cloud_of(planned(image).ledger[0])->state, EffectState::kOff);
  image.request.image.emplace();
  expect_unbounded(image);
}

// Rationale: rows are far below their bounds; a part that a bound lacks is seen in the bound alone.
// Expected: of a target that reflects nothing the line of sight and the background are left, each
// with its thermal light and its sunlight; a reflecting one has all sunlight of a clear sky, too,
// at the target and at the sensor.
TEST(CloudEffect, BoundsHaveEveryPart) {
  const CloudyScene s = body_under({{1, true}, {0, true}}, hot_box(), 300, 2, 2000, 0.02);
  const PreparedScene& scene = s.simulator->scene();
  auto around = ViewSurroundings::make(s.request, scene.target, 2000, scene.axis.node_um()).value();
  const CloudBounds cloud = around.cloud_bounds(0).value();
  const auto bounds_of = [&](double beyond_m2) {
    const std::vector<PilotLimits::Row> rows(4, {0, 0, 0});
    return effect_bounds(scene, s.request, {3, beyond_m2, rows}, nullptr, around);
  };
  const std::vector<RowBounds> black = bounds_of(0), bright = bounds_of(1);
  for (std::size_t b = 0; b < 2; ++b) {
    const BandOnAxis band = scene.axis.band(b);
    std::vector<double> thermal = cloud.most.thermal;
    for (std::size_t i = 0; i < thermal.size(); ++i) thermal[i] *= cloud.most.transmittance[i];
    const double path = in_band(cloud.path_surroundings, band),
                 path_sun = in_band(cloud.most.path_sun, band), behind = in_band(thermal, band),
                 behind_sun = in_band(cloud.most.background_sun, band);
    for (const double part : {path, path_sun, behind, behind_sun}) EXPECT_GT(part, 0);
    const RowBounds::Bound& of = black[b].cloud_unreflected;
    EXPECT_EQ(of.source, 0);
    EXPECT_NEAR(of.apparent, 3 * (path + path_sun), 1e-9 * of.apparent);
    EXPECT_NEAR(of.contrast, 3 * (behind + behind_sun), 1e-9 * of.contrast);
    const auto at = [](const RowBounds& row, Effect e) {
      return row.effect[static_cast<std::size_t>(e)];
    };
    const RowBounds::Bound all = at(bright[b], Effect::kCloud), left = bright[b].cloud_unreflected;
    RowBounds::Bound sun{false, in_band(cloud.most.thermal, band), behind, behind};
    for (const Effect e : {Effect::kDirectSun, Effect::kDiffuseSun, Effect::kMirroredSun}) {
      const RowBounds::Bound one = at(bright[2 + b], e);
      sun.source += one.source;
      sun.apparent += one.apparent;
      sun.contrast += one.contrast;
    }
    EXPECT_GE(all.source - left.source, sun.source * (1 - 1e-9));
    EXPECT_GE(all.apparent - left.apparent, sun.apparent * (1 - 1e-9));
    EXPECT_GE(all.contrast - left.contrast, sun.contrast * (1 - 1e-9));
  }
}

// Hot gas has no bound of what a cloud changes in the light behind it.
TEST(CloudEffect, HasNoBoundBehindHotGas) {
  CloudyScene s = body_under({{1, false}, {0, false}}, hot_box(), 1200, 3, 1000, 0.05);
  const auto cloud_bounds = [&] {
    const PreparedScene& scene = s.simulator->scene();
    return ViewSurroundings::make(s.request, scene.target, 1000, scene.axis.node_um())
        ->cloud_bounds(0);
  };
  EXPECT_TRUE(cloud_bounds().has_value());
  s.request.condition[0].gas = slab(10);
  EXPECT_FALSE(cloud_bounds().has_value());
}

// Rationale: in twilight the air scatters sunlight, though the disk has set.
// Expected: its effects are not absent from the row, those of the disk are; the target reflects
// the light, which is in neither a night's row nor one after twilight.
TEST(TwilightEffect, ScatteredSunlightOutlastsTheDisk) {
  const auto below = [](double deg) {
    const double e = deg * std::numbers::pi / 180;
    return Vec<Body>{std::cos(e), 0, std::sin(e)};
  };
  CloudyScene s =
      body_under({{0, true, kDeck, {}, below(1.5)}, {0, true, kDeck, {}, below(7)}, {0, false}},
                 generated("box", 12, 0, 20, 20, 10), 290, 3, 1000, 0.05);
  s.request.accuracy.samples_per_replicate = 64;
  s.request.effects.mode = EffectChoice::Mode::kAll;
  const std::vector<RowBounds> known = effects_without_bounds(s.simulator->scene(), s.request);
  const auto absent = [&](std::size_t condition, Effect e) {
    return known[2 * condition].effect[static_cast<std::size_t>(e)].absent;
  };
  for (const Effect e : {Effect::kDiffuseSun, Effect::kPathSun, Effect::kBackgroundSun}) {
    EXPECT_FALSE(absent(0, e)) << info_of(e).name;
    EXPECT_TRUE(absent(1, e)) << info_of(e).name;
    EXPECT_TRUE(absent(2, e)) << info_of(e).name;
  }
  EXPECT_TRUE(absent(0, Effect::kDirectSun));
  const auto view = s.simulator->simulate(s.request);
  ASSERT_TRUE(view.ok()) << view.status();
  const auto sunlight = [&](std::size_t condition) {
    double sum = 0;
    for (const Cause cause : {Cause::kSkyReflected, Cause::kSeaReflected})
      sum += view->row[2 * condition + 1].cause_w_sr[static_cast<std::size_t>(cause)].value;
    return sum;
  };
  EXPECT_GT(sunlight(0), sunlight(2));
  EXPECT_EQ(sunlight(1), sunlight(2));
}

}  // namespace
}  // namespace irsig
