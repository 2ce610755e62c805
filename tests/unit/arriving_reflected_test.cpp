// Rationale: rows are moved with what is interpolated between elevations of the sensor; what that
// adds to their errors must cover it, and must not be all of them.
// Expected: between the table's elevations what whole lines of sight say: within the spread, and to
// a few thousandths. Source: Environment, asked for the very line.
#include "view/moved/arriving_reflected.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/environment/environment.h"

namespace irsig {
namespace {

struct World {
  BandGrid grid;
  std::unique_ptr<const Environment> environment;

  [[nodiscard]] absl::StatusOr<std::vector<SightLine>> lines(
      double elevation_deg, double range_m, const std::vector<std::uint32_t>& conditions) const {
    const Viewpoint from{0, elevation_deg, range_m};
    Environment::Line line = environment->line(from);
    const Vec<Body> towards = body_from_aspect(0, elevation_deg);
    line.behind = BackgroundDirections({static_cast<float>(-towards.z)});
    const auto views = environment->view(line, conditions);
    if (!views.ok()) return views.status();
    std::vector<SightLine> out;
    for (const ViewEnvironment& view : *views)
      out.push_back(sight_line(view, environment->nodes(), grid, {{1}, {0}}));
    return out;
  }
};

WeatherSpec weather(double visibility_m,
                    SurfaceBoundary::Kind below = SurfaceBoundary::Kind::kRoughSea) {
  WeatherSpec w{{afgl_profile(AfglProfile::kMidlatitudeSummer), {}}, true, {}, nullptr};
  w.air.aerosol.kind = AerosolKind::kMaritime;
  w.air.aerosol.visibility_m = visibility_m;
  w.lower.kind = below;
  w.lower.temperature_k = 293;
  w.lower.wind_speed_m_s = 5;
  w.lower.emissivity = 0.9;
  return w;
}
Vec<Body> sun(double elevation_deg) {
  const double e = elevation_deg * std::numbers::pi / 180;
  return {0.9 * std::cos(e), std::sqrt(0.19) * std::cos(e), -std::sin(e)};
}

World world(const Band& band, double height_m, std::vector<WeatherSpec> weather,
            std::vector<ConditionEnvironment> condition) {
  World out;
  out.grid =
      make_band_grid(band, air_band_edges_um(band.lambda_min_um, band.lambda_max_um)).value();
  out.environment =
      Environment::make(std::move(weather), std::move(condition), height_m, out.grid.node_um)
          .value();
  return out;
}
// A clear day, a day in fog and a night.
World at_sea(const Band& band) {
  return world(band, 8, {weather(23e3), weather(1e3)},
               {{0, true, sun(48), 1}, {1, true, sun(48), 1}, {0, false, sun(48), 1}});
}
// Over the sun at the horizon: a mirror, without refraction; ground in haze.
World at_sunset(const Band& band, double height_m) {
  WeatherSpec straight = weather(50e3, SurfaceBoundary::Kind::kFlatSea);
  straight.refraction = false;
  return world(band, height_m, {straight, weather(4e3, SurfaceBoundary::Kind::kGround)},
               {{0, true, sun(0.3), 1}, {1, true, sun(-0.2), 1}, {0, true, sun(-3), 1}});
}

// Compares at so many elevations, between one range and others; worst: of the transmittance.
struct Found {
  int known = 0;
  double worst = 0;
};
Found compare(const World& w, double from_m, const std::vector<double>& ranges_m,
              double shape_within) {
  const std::vector<std::uint32_t> conditions{0, 1, 2};
  const auto lines = [&](double elevation_deg, double range_m,
                         const std::vector<std::uint32_t>& c) {
    return w.lines(elevation_deg, range_m, c);
  };
  ArrivingTable table;
  Found found;
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
        if (!spread) {
          ADD_FAILURE() << elevation_deg << " deg, to " << to_m << " m";
          continue;
        }
        ++found.known;
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
                << elevation_deg << " deg, to " << to_m << " m, condition " << c << ", side "
                << side << ", bin " << k << ", of " << through;
            found.worst = std::max(found.worst, off / through);
            EXPECT_GE((*spread)[side][k], 0.8 * exact[side][k]);
            EXPECT_LE((*spread)[side][k], 3 * exact[side][k] + shape_within * through);
          }
      }
    }
  }
  SightLine before, after;
  EXPECT_FALSE(table.complete(-1, from_m, ranges_m[0], 0, before, after).has_value());
  EXPECT_FALSE(table.complete(45, from_m, 3000, 0, before, after).has_value());
  return found;
}

TEST(ArrivingTable, IsWhatLinesOfSightSay) {
  for (const Band& band : {Band{"mwir", 3.4, 5, 0.1, {}}, Band{"lwir", 8, 12, 0.25, {}}}) {
    SCOPED_TRACE(band.name);
    const Found found = compare(at_sea(band), 5000, {1000, 5000, 20e3, 100e3}, 0.02);
    EXPECT_LT(found.worst, 2e-3);
    EXPECT_GT(found.known, 100);
  }
}

TEST(ArrivingTable, IsWhatLinesOfSightSayAtSunsetLowAndHighAndFarAway) {
  for (const Band& band : {Band{"mwir", 3.4, 5, 0.2, {}}, Band{"lwir", 8, 12, 0.5, {}}})
    for (const double height_m : {2.0, 10e3}) {
      SCOPED_TRACE(band.name + " " + std::to_string(height_m) + " m");
      const Found found = compare(at_sunset(band, height_m), 2000, {200, 50e3, 2e6}, 0.02);
      EXPECT_LT(found.worst, height_m > 1000 ? 1e-2 : 2e-3);
      EXPECT_GT(found.known, 100);
    }
}

// Where all directions arrive alike, what is left is that the table has few elevations.
TEST(ArrivingTable, HowFarItIsBentBetweenElevationsIsInItsSpread) {
  const auto line = [](double elevation_deg, double range_m) {
    const double share =
        0.4 + 0.5 * std::exp(-std::sin(elevation_deg * std::numbers::pi / 180) * range_m / 5e2);
    SightLine out;
    out.bin.width = out.bin.transmittance = {1};
    for (auto& arriving : out.bin.arriving) arriving = {share};
    out.band = out.bin;
    out.directions = {SightLine::Values{share}, SightLine::Values{share}};
    return out;
  };
  ArrivingTable table;
  double worst = 0;
  for (double elevation_deg = 0.1; elevation_deg < 90; elevation_deg += 0.7) {
    for (const auto& task : table.lacking(elevation_deg, 1e3, {1e5}, {0}))
      ArrivingTable::compute(task, [&](double e, double r, const std::vector<std::uint32_t>&) {
        return std::vector{line(e, r)};
      });
    const SightLine here = line(elevation_deg, 1e3), there = line(elevation_deg, 1e5);
    SightLine before = here, after = there;
    const auto spread = table.complete(elevation_deg, 1e3, 1e5, 0, before, after);
    ASSERT_TRUE(spread.has_value());
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t cause = SightLine::kReflected[side];
      const auto moved = [&](const SightLine& from, const SightLine& to) {
        return to.bin.arriving[cause][0] - from.bin.arriving[cause][0];
      };
      const double off = std::abs(moved(before, after) - moved(here, there));
      EXPECT_LE(off, (*spread)[side][0] + 1e-7) << elevation_deg;
      EXPECT_LE((*spread)[side][0], 0.05);
      worst = std::max(worst, off);
    }
  }
  EXPECT_GT(worst, 1e-3);
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
  const World w = at_sea({"lwir", 8, 12, 0.5, {}});
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
