// Tests the changes by effects of temperatures that are left out, and the bounds on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/constants.h"
#include "core/thermal/scene/scene_heat.h"
#include "heat_scene.h"

namespace irsig {
namespace {

// A day with sunlight from 6 to 18 h, half of it from the sky, and calm nights.
SceneHeatRequest day(double step_s) {
  SceneHeatRequest r;
  const auto knots = static_cast<std::size_t>(std::lround(86400 / step_s));
  for (std::size_t k = 0; k <= knots; ++k) {
    const double t = step_s * static_cast<double>(k), angle = 2 * M_PI * t / 86400,
                 up = -std::cos(angle);
    const HeatRadiation light{up > 0 ? 700 * up : 0, up > 0 ? 250 * up : 0, 320};
    r.knot_s.push_back(t);
    r.weather.push_back({288 - 5 * std::cos(angle),
                         2 + up,
                         {1, 0, 0},
                         {std::sin(angle), 0.3, 0.8 * std::cos(angle)},
                         0.0047,
                         light,
                         light});
    const double size = length(r.weather.back().sun);
    r.weather.back().sun = (1 / size) * r.weather.back().sun;
    if (k % (knots / 8) == 0) r.output_knot.push_back(k);
  }
  r.day_knots = knots;
  r.beneath = {.surface_z_m = 0.5, .temperature_k = 290, .emissivity = 0.95, .solar_albedo = 0.2};
  WallBuildUp soil{.name = "soil", .layers = {{0.3, 1.0, 1800, 1000}}};
  WallBuildUp wall{.name = "wall", .layers = {{0.005, 45, 7850, 490}}};
  wall.inner_side = InnerSide::kAir;
  wall.inner_k = 294;
  wall.inner_h_w_m2_k = 5;
  r.build_up = {soil, wall};
  r.part = {{0.75, 0.94, 0u, 0}, {0.6, 0.9, 1u, 0}};
  return r;
}

// A house on its ground, 3 m high.
Target yard() {
  Mesh mesh = plate("ground", {-4, -4, 0}, {0, 8, 0}, {8, 0, 0}, 4);
  Mesh house = generated("box", 48, 0, 2, 3, 3);
  for (auto& v : house.vertex) v = v + Vec<Body>{1, 0, -1.51};
  house = named(std::move(house), "walls");
  append(mesh, house);
  return target_of(mesh, {part("ground"), part("walls")});
}

SceneHeatResult solved(const Target& target, const SceneHeatRequest& request) {
  auto result = solve_scene_heat(target, request);
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *std::move(result) : SceneHeatResult{};
}

struct Compared {
  double largest_k = 0, largest_of_bound = 0, largest_bound_k = 0;
};
// Facet by facet: how much two results differ, and of a bound at most which share.
Compared compared(const SceneHeatResult& a, const SceneHeatResult& b,
                  const std::function<double(std::size_t)>& bound_k) {
  Compared out;
  for (std::size_t t = 0; t < a.kelvin.size(); ++t)
    for (std::size_t f = 0; f < a.kelvin[t].size(); ++f) {
      if (std::isnan(a.kelvin[t][f])) continue;
      const double off = std::abs(static_cast<double>(a.kelvin[t][f] - b.kelvin[t][f]));
      out.largest_k = std::max(out.largest_k, off);
      out.largest_bound_k = std::max(out.largest_bound_k, bound_k(f));
      out.largest_of_bound = std::max(out.largest_of_bound, off / (bound_k(f) + 0.03));
    }
  return out;
}

double at(const std::vector<float>& of_facets, std::size_t f) {
  return static_cast<double>(of_facets[f]);
}

// Rationale: a bound says how much an effect could have mattered, whichever side was computed.
// Expected: never less than what both sides differ by at any facet and time; not more than a few
// times the largest difference (1.6 and 2.4 of exchange, 1.5 of diffuse sunlight).
TEST(HeatEffects, BoundsCoverWhatLeavingOutChanges) {
  const Target target = yard();
  SceneHeatRequest request = day(1800);
  request.effect_bounds = true;
  const SceneHeatResult all = solved(target, request);
  const auto without = [&](bool exchange, bool diffuse_sun) {
    SceneHeatRequest r = request;
    r.exchange = exchange;
    r.diffuse_sun = diffuse_sun;
    r.effect_bounds = false;
    return solved(target, r);
  };
  const SceneHeatResult no_exchange = without(false, true), no_diffuse = without(true, false),
                        neither = without(false, false);
  const auto check = [&](const char* what, const SceneHeatResult& other,
                         const std::function<double(std::size_t)>& bound_k, double least_k,
                         double most_times) {
    const Compared c = compared(all, other, bound_k);
    std::printf("%s: differs by up to %.2f K, %.2f of the bound there, bounds up to %.2f K\n", what,
                c.largest_k, c.largest_of_bound, c.largest_bound_k);
    EXPECT_LE(c.largest_of_bound, 1) << what;
    EXPECT_GT(c.largest_k, least_k) << what;
    EXPECT_LT(c.largest_bound_k, most_times * c.largest_k) << what;
  };
  check(
      "exchange, from all", no_exchange, [&](std::size_t f) { return at(all.exchange_bound_k, f); },
      0.5, 4);
  check(
      "exchange, from without", no_exchange,
      [&](std::size_t f) { return at(no_exchange.exchange_bound_k, f); }, 0.5, 6);
  check(
      "diffuse sunlight, from all", no_diffuse,
      [&](std::size_t f) { return at(all.diffuse_sun_bound_k, f); }, 3, 4);
  check(
      "diffuse sunlight, from without", no_diffuse,
      [&](std::size_t f) { return at(no_diffuse.diffuse_sun_bound_k, f); }, 3, 4);
  check(
      "both", neither,
      [&](std::size_t f) {
        return at(neither.exchange_bound_k, f) + at(neither.diffuse_sun_bound_k, f);
      },
      3, 5);
  // Only bounds of effects that are left out are in the error.
  for (std::size_t f = 0; f < target.facet.size(); ++f) {
    EXPECT_GE(no_diffuse.error_k[3][f], no_diffuse.diffuse_sun_bound_k[f]);
    EXPECT_GE(neither.error_k[3][f], neither.diffuse_sun_bound_k[f] + neither.exchange_bound_k[f]);
    EXPECT_LT(no_exchange.error_k[3][f] - no_exchange.exchange_bound_k[f], all.error_k[3][f] + 2);
  }
}

// Rationale: under a clear sky faces are colder than the air, which stands for them where exchange
// is left out. Expected: the bound covers what that warms, and is no more than a few times it.
TEST(HeatEffects, ANightWithoutExchangeIsWarmer) {
  const Target target = yard();
  SceneHeatRequest r = day(1800);
  for (HeatWeather& w : r.weather) w.before = w.after = {0, 0, 220};
  r.effect_bounds = true;
  const SceneHeatResult with = solved(target, r);
  r.exchange = false;
  const SceneHeatResult without = solved(target, r);
  for (const SceneHeatResult* from : {&with, &without}) {
    const Compared c =
        compared(with, without, [&](std::size_t f) { return at(from->exchange_bound_k, f); });
    EXPECT_LE(c.largest_of_bound, 1);
    EXPECT_GT(c.largest_k, 0.3);
    EXPECT_LT(c.largest_bound_k, 5 * c.largest_k);
  }
  // Face by face: the wall that sees no other face has less than the ground before it.
  const auto [least, most] = std::ranges::minmax(without.exchange_bound_k);
  EXPECT_LT(least, 0.5F * most);
}

// Rationale: asking for bounds must not change what they are bounds of.
// Expected: the same bits; no bounds where none were asked for and nothing is left out.
TEST(HeatEffects, BoundsChangeNoTemperature) {
  const Target target = yard();
  SceneHeatRequest request = day(1800);
  const SceneHeatResult plain = solved(target, request);
  request.effect_bounds = true;
  const SceneHeatResult bounded = solved(target, request);
  EXPECT_EQ(plain.kelvin, bounded.kelvin);
  EXPECT_EQ(plain.error_k, bounded.error_k);
  EXPECT_TRUE(plain.exchange_bound_k.empty());
  EXPECT_EQ(bounded.exchange_bound_k.size(), target.facet.size());
}

// Rationale: the closed form of a plate without heat capacity on both sides of the day: absorbed
// light dq warms it by the root of its balance. Expected: 0 < difference <= bound, and the bound is
// within 25 % of it: in a wind, where h and emission are nearly linear, it is nearly sharp.
TEST(HeatEffects, ABoundIsNearlySharpForOnePlate) {
  const Target target = target_of(generated("disk", 16), {part("disk")});
  SceneHeatRequest r = day(1800);
  for (HeatWeather& w : r.weather) {
    w.wind_m_s = 8;
    w.before = w.after = {0, 200, 330};
    w.sun = {0.6, 0, -0.8};
  }
  r.build_up = {{.name = "foil", .layers = {{0.001, 45, 7850, 490}}}};
  r.part = {{0.7, 0.9, 0u, 0}};
  r.beneath.surface_z_m = INFINITY;
  r.rays = 1024;
  r.effect_bounds = true;
  const SceneHeatResult with = solved(target, r);
  SceneHeatRequest dark = r;
  dark.diffuse_sun = false;
  const SceneHeatResult without = solved(target, dark);
  for (std::size_t f = 0; f < target.facet.size(); ++f) {
    double largest_k = 0;
    for (std::size_t t = 0; t < with.kelvin.size(); ++t)
      largest_k =
          std::max(largest_k, static_cast<double>(with.kelvin[t][f] - without.kelvin[t][f]));
    EXPECT_GT(largest_k, 1);
    for (const SceneHeatResult* from : {&with, &without}) {
      EXPECT_LE(largest_k, at(from->diffuse_sun_bound_k, f));
      EXPECT_GT(largest_k, 0.75 * at(from->diffuse_sun_bound_k, f));
      EXPECT_LT(at(from->exchange_bound_k, f), 0.01) << "a plate alone sees no other";
    }
  }
}

// Rationale: in a deep well what warms one face comes back from the others, so that a face by
// itself would be expected to change too little. Expected: the bound of diffuse sunlight covers
// what it changes there, which is more than the least that a face alone would allow for.
TEST(HeatEffects, InAWellFacesAnswerToEachOther) {
  Mesh mesh = plate("floor", {-1, -1, 0}, {0, 2, 0}, {2, 0, 0}, 2);
  append(mesh, plate("west", {-1, -1, 0}, {0, 0, -6}, {0, 2, 0}, 3));
  append(mesh, plate("east", {1, -1, 0}, {0, 2, 0}, {0, 0, -6}, 3));
  append(mesh, plate("south", {-1, -1, 0}, {2, 0, 0}, {0, 0, -6}, 3));
  append(mesh, plate("north", {-1, 1, 0}, {0, 0, -6}, {2, 0, 0}, 3));
  const Target target =
      target_of(mesh, {part("floor"), part("west"), part("east"), part("south"), part("north")});
  SceneHeatRequest r = day(1800);
  for (HeatWeather& w : r.weather) {
    w.wind_m_s = 0;
    w.before.direct_normal_w_m2 = w.after.direct_normal_w_m2 = 0;
  }
  r.build_up = {{.name = "sheet", .layers = {{0.001, 45, 7850, 490}}}};
  r.part.assign(5, {0.9, 0.95, 0u, 0});
  r.effect_bounds = true;
  const SceneHeatResult with = solved(target, r);
  r.diffuse_sun = false;
  const SceneHeatResult without = solved(target, r);
  for (const SceneHeatResult* from : {&with, &without}) {
    const Compared c =
        compared(with, without, [&](std::size_t f) { return at(from->diffuse_sun_bound_k, f); });
    std::printf("differs by up to %.2f K, %.2f of the bound there, bounds up to %.2f K\n",
                c.largest_k, c.largest_of_bound, c.largest_bound_k);
    EXPECT_LE(c.largest_of_bound, 1);
    EXPECT_GT(c.largest_of_bound, 0.3);
  }
}

// Rationale: where faces see nothing but each other and lose nothing by themselves, a change of
// what they send may grow: nothing is known, and that is said. Expected: an error that names the
// part, not a number.
TEST(HeatEffects, WithoutABoundNothingIsLeftOut) {
  Mesh box = generated("box", 48, 0, 4, 4, 4);
  for (auto& t : box.triangle) std::swap(t[1], t[2]);
  box = named(std::move(box), "inside");
  const Target target = target_of(box, {part("inside")});
  SceneHeatRequest r = day(1800);
  for (HeatWeather& w : r.weather) w.wind_m_s = 0;
  r.build_up = {{.name = "mirror", .layers = {{0.005, 45, 7850, 490}}}};
  r.build_up[0].inner_side = InnerSide::kHeatFlux;
  r.build_up[0].inner_flux_w_m2 = 3000;
  r.part = {{0.7, 0.9, 0u, 0}};
  r.beneath.surface_z_m = INFINITY;
  r.exchange = false;
  const auto result = solve_scene_heat(target, r);
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.status().message().find("heat_exchange cannot be left out"), std::string::npos)
      << result.status();
  EXPECT_NE(result.status().message().find("\"inside\""), std::string::npos);
}

}  // namespace
}  // namespace irsig
