// Rationale: a cloud is left out of rows where the most that it can change fits into their error,
// and is in their ledger wherever there is one.
// Expected: bounds of the ledger hold against rows under a clear sky on the same paths, for broken
// and overcast skies, by day and night; a hot body under a cloud has the rows of the clear sky,
// bit by bit, with the bound in its error; a line of sight that reaches the cloud has no bound.
// Source: the same program with and without the cloud.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/accuracy/replicates.h"
#include "core/environment/environment.h"
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
    c.sun_direction = normalized(Vec<Body>{0.3, 0.5, -0.8});
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
      // The background has its cloud; by day its sunlight may be left out, too.
      const double behind = row.background_radiance_w_m2_sr.value,
                   with_cloud = truth.row[i].background_radiance_w_m2_sr.value;
      EXPECT_NEAR(behind, with_cloud, (sun ? 1e-2 : 1e-4) * with_cloud)
          << row.condition << " " << row.band;
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

}  // namespace
}  // namespace irsig
