// Rationale: rows are moved with what is interpolated between elevations of the sensor; what that
// adds to their errors must cover it, and must not be all of them.
// Expected: between the table's elevations what whole lines of sight say: within the spread, and to
// a few thousandths. Source: Environment, asked for the very line.
#include "view/arriving_reflected.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/environment/environment.h"

namespace irsig {
namespace {

constexpr double kHeightM = 8;

struct World {
  BandGrid grid;
  std::unique_ptr<const Environment> environment;

  [[nodiscard]] absl::StatusOr<std::vector<SightLine>> lines(
      double elevation_deg, double range_m, const std::vector<std::uint32_t>& conditions) const {
    const Viewpoint from{0, elevation_deg, range_m};
    Environment::Line line = environment->line(from);
    const Vec<Body> towards = body_from_aspect(0, elevation_deg);
    line.behind = BehindNodes({static_cast<float>(-towards.z)});
    const auto views = environment->view(line, conditions);
    if (!views.ok()) return views.status();
    std::vector<SightLine> out;
    for (const ViewEnvironment& view : *views)
      out.push_back(sight_line(view, environment->nodes(), grid));
    return out;
  }
};

// A clear day, a day in fog and a night.
World world(const Band& band) {
  World out;
  out.grid =
      make_band_grid(band, air_band_edges_um(band.lambda_min_um, band.lambda_max_um)).value();
  std::vector<WeatherSpec> weather;
  for (const double visibility_m : {23e3, 1e3}) {
    WeatherSpec w{{afgl_profile(AfglProfile::kMidlatitudeSummer), {}}, true, {}, nullptr};
    w.air.aerosol.kind = AerosolKind::kMaritime;
    w.air.aerosol.visibility_m = visibility_m;
    w.lower.temperature_k = 293;
    w.lower.wind_speed_m_s = 5;
    weather.push_back(std::move(w));
  }
  const Vec<Body> sun{0.6, 0.3, -std::sqrt(1 - 0.45)};
  out.environment = Environment::make(std::move(weather),
                                      {{0, true, sun, 1}, {1, true, sun, 1}, {0, false, sun, 1}},
                                      kHeightM, out.grid.node_um)
                        .value();
  return out;
}

TEST(ArrivingTable, IsWhatLinesOfSightSay) {
  for (const Band& band : {Band{"mwir", 3.4, 5, 0.1, {}}, Band{"lwir", 8, 12, 0.25, {}}}) {
    const World w = world(band);
    const std::vector<std::uint32_t> conditions{0, 1, 2};
    const double from_m = 5000;
    const std::vector<double> ranges_m{1000, 5000, 20e3, 100e3};
    const auto lines = [&](double elevation_deg, double range_m,
                           const std::vector<std::uint32_t>& c) {
      return w.lines(elevation_deg, range_m, c);
    };
    ArrivingTable table;
    double worst = 0;
    int known = 0;
    for (const double elevation_deg :
         {0.2, 1.0, 2.5, 4.0, 7.0, 11.0, 17.0, 26.0, 38.0, 52.0, 71.0, 83.0, 90.0}) {
      for (const auto& task : table.lacking(elevation_deg, from_m, ranges_m, conditions))
        ArrivingTable::compute(task, lines);
      EXPECT_TRUE(table.lacking(elevation_deg, from_m, ranges_m, conditions).empty());
      const auto from = w.lines(elevation_deg, from_m, conditions);
      for (const double to_m : ranges_m) {
        const auto to = w.lines(elevation_deg, to_m, conditions);
        for (const std::uint32_t c : conditions) {
          if (!from.ok() || !to.ok()) continue;
          const SightLine &here = (*from)[c], &there = (*to)[c];
          SightLine before = here, after = there;
          const auto spread = table.complete(elevation_deg, from_m, to_m, c, before, after);
          ASSERT_TRUE(spread.has_value());
          ++known;
          const ReflectedSpread exact = spread_of(here, there);
          for (std::size_t side = 0; side < 2; ++side)
            for (std::size_t k = 0; k < here.bin.width.size(); ++k) {
              const std::size_t cause = SightLine::kReflected[side];
              const double through = there.bin.transmittance[k],
                           keep = through / here.bin.transmittance[k];
              if (!(through > 1e-12 && here.bin.transmittance[k] > 1e-12)) continue;
              const auto moved = [&](const SightLine& one, const SightLine& other) {
                return other.bin.arriving[cause][k] - keep * one.bin.arriving[cause][k];
              };
              const double off = std::abs(moved(before, after) - moved(here, there));
              EXPECT_LE(off, (*spread)[side][k])
                  << band.name << " " << elevation_deg << " deg, to " << to_m << " m, condition "
                  << c << ", side " << side << ", bin " << k << ", of " << through;
              worst = std::max(worst, off / through);
              EXPECT_GE((*spread)[side][k], 0.8 * exact[side][k]);
              EXPECT_LE((*spread)[side][k], 3 * exact[side][k] + 0.02 * through);
            }
        }
      }
    }
    EXPECT_LT(worst, 2e-3) << band.name;
    EXPECT_GT(known, 100);
    SightLine before, after;
    EXPECT_FALSE(table.complete(-1, from_m, 1000, 0, before, after).has_value());
    EXPECT_FALSE(table.complete(45, from_m, 3000, 0, before, after).has_value());
  }
}

TEST(ArrivingTable, WhereThereAreNoLinesNothingIsKnown) {
  ArrivingTable table;
  for (const auto& task : table.lacking(20, 3000, {5000}, {0}))
    ArrivingTable::compute(task, [](double, double, const std::vector<std::uint32_t>&) {
      return absl::InvalidArgumentError("no path was imported");
    });
  SightLine from, to;
  EXPECT_FALSE(table.complete(20, 3000, 5000, 0, from, to).has_value());
}

TEST(ArrivingTable, TheOwnRangeHasNoSpread) {
  const World w = world({"lwir", 8, 12, 0.5, {}});
  ArrivingTable table;
  for (const auto& task : table.lacking(20, 3000, {3000}, {0}))
    ArrivingTable::compute(task, [&](double e, double r, const std::vector<std::uint32_t>& c) {
      return w.lines(e, r, c);
    });
  auto from = w.lines(20, 3000, {0}), to = w.lines(20, 3000, {0});
  ASSERT_TRUE(from.ok() && to.ok());
  const auto spread = table.complete(20, 3000, 3000, 0, (*from)[0], (*to)[0]);
  ASSERT_TRUE(spread.has_value());
  for (const auto& side : *spread)
    for (const double s : side) EXPECT_NEAR(s, 0, 1e-12);
  for (const std::size_t cause : SightLine::kReflected)
    EXPECT_EQ((*from)[0].bin.arriving[cause], (*to)[0].bin.arriving[cause]);
}

}  // namespace
}  // namespace irsig
