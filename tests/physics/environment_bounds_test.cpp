// Rationale: effects are left out on the word of bounds that see no ring of the sky; a bound that
// is too low loses light in silence. Expected: whatever Environment::view computes lies at or below
// its bound, in every weather, under every sun, along every line; what is not asked for is 0 and
// what is asked for has the same bits as in the whole view; joining the air's lines at three rings
// errs by less than is stated. Source: Environment::view, which other tests compare with sums over
// every step; for the sun's glitter a quadrature of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "core/environment/environment.h"
#include "core/environment/sea/sea_surface.h"
#include "tests/physics/around_spectra.h"

namespace irsig {
namespace {

constexpr double kElevationsDeg[] = {1, 10, 40, 85, -1.2};  // the last: twilight

std::vector<double> wavelengths() {
  std::vector<double> um;
  for (double x = 2.96; x < 5.2; x += 0.09) um.push_back(x);
  for (double x = 7.6; x < 15; x += 0.31) um.push_back(x);
  return um;
}

WeatherSpec weather(AfglProfile profile, AerosolKind kind, double visibility_m,
                    SurfaceBoundary lower) {
  WeatherSpec w{{afgl_profile(profile), {}}, true, lower, nullptr};
  w.air.aerosol.kind = kind;
  w.air.aerosol.visibility_m = visibility_m;
  return w;
}

struct Named {
  const char* name;
  WeatherSpec spec;
};
std::vector<Named> weathers() {
  const auto sea = [](double temperature_k, double wind_m_s) {
    return SurfaceBoundary{SurfaceBoundary::Kind::kRoughSea, temperature_k, 1, wind_m_s};
  };
  std::vector<Named> all = {
      {"clear",
       weather(AfglProfile::kMidlatitudeSummer, AerosolKind::kMaritime, 23e3, sea(293, 2))},
      {"very clear, storm",
       weather(AfglProfile::kSubarcticWinter, AerosolKind::kRural, 80e3, sea(275, 18))},
      {"no aerosol", weather(AfglProfile::kTropical, AerosolKind::kNone, 0, sea(300, 7))},
      {"haze, ground", weather(AfglProfile::kTropical, AerosolKind::kUrban, 3e3,
                               {SurfaceBoundary::Kind::kGround, 310, 0.8, 0})},
      {"fog, flat", weather(AfglProfile::kMidlatitudeWinter, AerosolKind::kAdvectionFog, 300,
                            {SurfaceBoundary::Kind::kFlatSea, 278, 1, 0})},
      {"radiation fog",
       weather(AfglProfile::kMidlatitudeSummer, AerosolKind::kRadiationFog, 1e3, sea(288, 5))}};
  WeatherSpec navy = weather(AfglProfile::kTropical, AerosolKind::kNavyMaritime, 0, sea(302, 12));
  navy.air.aerosol.wind_speed_m_s = navy.air.aerosol.wind_speed_24h_m_s = 12;
  all.push_back({"navy", navy});
  // Bent to surfaces far from the profile's; inversions.
  WeatherSpec cold =
      weather(AfglProfile::kSubarcticWinter, AerosolKind::kRural, 40e3, sea(271, 20));
  cold.air.profile = *bend_to_surface(cold.air.profile, {213.15, 0, 103e3});
  all.push_back({"cold air over the sea", cold});
  WeatherSpec hot = weather(AfglProfile::kTropical, AerosolKind::kMaritime, 50e3,
                            {SurfaceBoundary::Kind::kGreySea, 310, 0.97, 0});
  hot.air.profile = *bend_to_surface(hot.air.profile, {323.15, 30, 100e3});
  all.push_back({"hot", hot});
  return all;
}

ConditionEnvironment sunny(double elevation_deg, std::uint32_t of_weather = 0) {
  const double e = elevation_deg * M_PI / 180, a = 0.7;
  return {
      of_weather, true, {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), -std::sin(e)}, 0.99};
}

// Behind the target: sky, the horizon and sea on the far side; some of it towards the sun.
Environment::Line line(double range_m, double elevation_deg, double aspect_deg) {
  const Vec<Body> d = body_from_aspect(aspect_deg, elevation_deg);
  return {range_m, elevation_deg, d,
          BackgroundDirections({-0.6f, -0.17f, -0.02f, 0.0f, 0.001f, 0.01f, 0.05f, 0.2f, 0.6f},
                               std::atan2(-d.y, -d.x))};
}
// Looking at the target with the sun behind it, beside it and behind the sensor; and from above.
std::vector<Environment::Line> lines() {
  const double sun_deg = 0.7 * 180 / M_PI;
  return {line(500, 5, sun_deg + 180),   line(5000, 0.03, sun_deg + 170),
          line(5000, 0.03, sun_deg),     line(50e3, 10, sun_deg + 90),
          line(20e3, 40, sun_deg + 180), line(50, -5, sun_deg + 180)};
}

std::unique_ptr<const Environment> environment(const WeatherSpec& w, double height_m = 10) {
  std::vector<ConditionEnvironment> conditions = {{}};
  for (const double e : kElevationsDeg) conditions.push_back(sunny(e));
  auto made = Environment::make({w}, std::move(conditions), height_m, wavelengths());
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

// Trapezoids over sines, as the nodes are read.
std::vector<double> over_all_directions(const DirectionNodes& nodes,
                                        const std::vector<std::vector<double>>& radiance) {
  std::vector<double> sum(radiance[0].size(), 0.0);
  const std::uint32_t az = nodes.azimuths();
  for (std::uint32_t n = 0; n < nodes.count(); ++n) {
    const bool up = n < nodes.sky();
    const std::uint32_t first = up ? 0 : nodes.sky(), end = up ? nodes.sky() : nodes.count();
    const double s = std::abs(nodes.sin_elevation(n));
    const double below = n < first + az ? -s : std::abs(nodes.sin_elevation(n - az));
    const double above = n + az >= end ? 2 - s : std::abs(nodes.sin_elevation(n + az));
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += 2 * M_PI / az * 0.5 * (above - below) * radiance[n][i];
    }
  }
  return sum;
}

// Collects how close values come to their bounds.
class Tightness {
 public:
  void expect(const char* what, const std::string& where, const std::vector<double>& is,
              const std::vector<double>& bound, double noise = 0) {
    const std::vector<double> um = wavelengths();
    double& worst = worst_[what];
    for (std::size_t i = 0; i < um.size(); ++i) {
      // Differences of day and night are known to a few units in the last place of either.
      EXPECT_LE(is[i], bound[i] * (1 + 1e-12) + noise)
          << what << " at " << um[i] << " um, " << where;
      if (bound[i] > 1e3 * noise && bound[i] > 0) worst = std::max(worst, is[i] / bound[i]);
    }
  }
  ~Tightness() {
    for (const auto& [what, ratio] : worst_) std::printf("%-28s %.3f\n", what.c_str(), ratio);
  }

 private:
  std::map<std::string, double> worst_;
};

std::vector<double> less(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

// Compares all light that a line shows under all conditions with its bounds.
void expect_bounded(const Environment& e, const Environment::Line& l, const std::string& name,
                    Tightness& tight) {
  auto look = e.sight_line(l);
  if (!look.ok()) return;  // below the surface from so low
  const std::vector<std::uint32_t> all = {0, 1, 2, 3, 4, 5};
  const auto views = *e.view(l, all);
  const ViewEnvironment& night = views[0];
  // Differences of day and night are known to a few units in the last place of either.
  const double noise = 1e-12;
  for (const std::uint32_t c : all) {
    const ViewEnvironment& v = views[c];
    const LightBounds& b = look->bounds(c);
    const std::string where =
        name + ", condition " + std::to_string(c) + ", range " + std::to_string(l.range_m);
    EXPECT_EQ(b.transmittance, v.transmittance);
    tight.expect("air's own emission", where, b.path_radiance, night.path_radiance);
    const auto node = radiance_of(v.around), apparent = apparent_of(v.around),
               night_node = radiance_of(night.around), night_apparent = apparent_of(night.around);
    for (const auto* nodes : {&night_node, &night_apparent, &night.background_apparent}) {
      for (const auto& spectrum : *nodes) tight.expect("thermal", where, spectrum, b.thermal);
    }
    tight.expect("direct sun", where, v.sun, b.sun);
    tight.expect("direct sun, apparent", where, v.sun_apparent, b.sun);
    std::vector<std::vector<double>> scattered;
    for (std::size_t n = 0; n < node.size(); ++n) {
      scattered.push_back(less(node[n], night_node[n]));
      tight.expect("diffuse sun", where, scattered.back(), b.diffuse_sun, noise);
      tight.expect("diffuse sun, apparent", where, less(apparent[n], night_apparent[n]),
                   b.diffuse_sun, noise);
    }
    tight.expect("diffuse sun, all directions", where, over_all_directions(e.nodes(), scattered),
                 b.diffuse_sun_w_m2_um, noise);
    tight.expect("path sun", where, less(v.path_radiance, night.path_radiance), b.path_sun, noise);
    for (std::size_t n = 0; n < v.background_apparent.size(); ++n) {
      tight.expect("background sun", where,
                   less(v.background_apparent[n], night.background_apparent[n]), b.background_sun,
                   noise);
    }
    if (c != 0) continue;
    for (const auto* none : {&b.sun, &b.diffuse_sun, &b.diffuse_sun_w_m2_um, &b.path_sun,
                             &b.background_sun, &b.mirrored_sun, &b.mirrored_sun_w_m2_um}) {
      for (const double x : *none) EXPECT_EQ(x, 0);
    }
  }
}

TEST(EnvironmentBounds, NothingExceedsThem) {
  for (const double height_m : {10.0, 2000.0}) {
    for (const Named& w : weathers()) {
      const auto e = environment(w.spec, height_m);
      Tightness tight;
      std::printf("-- %s, from %g m: largest part of the bound\n", w.name, height_m);
      for (const Environment::Line& l : lines()) expect_bounded(*e, l, w.name, tight);
    }
  }
}

// Opaque, thin and in shreds; the target below, inside and above the layer.
TEST(EnvironmentBounds, NothingUnderACloudExceedsThem) {
  struct Case {
    const char* name;
    CloudSpec cloud;
    std::size_t weather;
    double height_m;
  };
  for (const Case& c : {Case{"stratus", {CloudPhase::kWater, 330, 1000, 0.2, 7.9}, 0, 10},
                        Case{"thin stratus", {CloudPhase::kWater, 330, 1000, 3e-3, 7.9}, 3, 10},
                        Case{"large drops", {CloudPhase::kWater, 100, 3000, 0.01, 50}, 0, 2000},
                        Case{"cirrus", {CloudPhase::kIce, 10000, 11000, 0.0067, 64}, 0, 10},
                        Case{"small crystals", {CloudPhase::kIce, 1500, 2500, 0.004, 6.4}, 0, 12e3},
                        Case{"on the ground", {CloudPhase::kWater, 0, 200, 0.02, 4}, 3, 10}}) {
    Named w = weathers()[c.weather];
    w.spec.cloud = c.cloud;
    w.spec.cloud_cover = 1;
    const auto e = environment(w.spec, c.height_m);
    Tightness tight;
    std::printf("-- %s, %s, from %g m: largest part of the bound\n", c.name, w.name, c.height_m);
    for (const Environment::Line& l : lines())
      expect_bounded(*e, l, std::string(c.name) + ", " + w.name, tight);
  }
}

// Rationale: a cloud changes light by no more than the brighter of both skies has.
// Expected: the bound is the larger one of the clear and the overcast sky, for every kind of light,
// and bounds what the line of sight scatters of the cloud by night; there is none where the sensor,
// the target or a part of it may be above the base, and the clear sky has none.
TEST(EnvironmentBounds, OfACloudAreTheLargerOfBothSkies) {
  const WeatherSpec clear_sky = weathers()[0].spec;
  WeatherSpec deck = clear_sky;
  deck.cloud = {CloudPhase::kWater, 330, 1000, 0.2, 7.9};
  deck.cloud_cover = 1;
  const auto environment_of = [](const WeatherSpec& w) {
    return *Environment::make({w}, {{}, sunny(40)}, 10, wavelengths());
  };
  const auto clear = environment_of(clear_sky), overcast = environment_of(deck);
  const Environment::Line of = line(3000, 2, 100);
  auto without = *clear->sight_line(of), with = *overcast->sight_line(of);
  std::size_t clear_is_larger = 0, overcast_is_larger = 0;
  for (const std::uint32_t c : {0u, 1u}) {
    EXPECT_FALSE(without.cloud_bounds(c).has_value());
    const auto cloud = with.cloud_bounds(c);
    ASSERT_TRUE(cloud.has_value());
    const LightBounds &a = without.bounds(c), &b = with.bounds(c);
    for (const auto member :
         {&LightBounds::transmittance, &LightBounds::path_radiance, &LightBounds::thermal,
          &LightBounds::sun, &LightBounds::diffuse_sun, &LightBounds::diffuse_sun_w_m2_um,
          &LightBounds::mirrored_sun, &LightBounds::mirrored_sun_w_m2_um, &LightBounds::path_sun,
          &LightBounds::background_sun})
      for (std::size_t i = 0; i < (a.*member).size(); ++i) {
        EXPECT_DOUBLE_EQ((cloud->most.*member)[i], std::max((a.*member)[i], (b.*member)[i]));
        clear_is_larger += (a.*member)[i] > 1.01 * (b.*member)[i];
        overcast_is_larger += (b.*member)[i] > 1.01 * (a.*member)[i];
      }
    if (c > 0) continue;
    const std::vector<std::uint32_t> night = {0};
    const ViewEnvironment clear_night = clear->view(of, night)->front(),
                          dim_night = overcast->view(of, night)->front();
    double most = 0;
    for (std::size_t i = 0; i < wavelengths().size(); ++i) {
      const double change = std::abs(dim_night.path_radiance[i] - clear_night.path_radiance[i]);
      EXPECT_LE(change, cloud->path_surroundings[i] * (1 + 1e-9) + 1e-15);
      most = std::max(most, change);
    }
    EXPECT_GT(most, 0);
  }
  EXPECT_GT(clear_is_larger, 0U);
  EXPECT_GT(overcast_is_larger, 0U);
  Environment::Line tall = of, steep = line(1000, 30, 100);
  tall.end.push_back({3000, 300});
  EXPECT_TRUE(overcast->sight_line(tall)->cloud_bounds(0).has_value());
  tall.end.push_back({3000, 340});
  EXPECT_FALSE(overcast->sight_line(tall)->cloud_bounds(0).has_value());
  EXPECT_FALSE(overcast->sight_line(steep)->cloud_bounds(0).has_value());
}

TEST(EnvironmentBounds, NothingOfAnImportedPathExceedsThem) {
  const double nan = std::nan("");
  for (const bool radiance : {true, false}) {
    ImportedPath path{14.6, 10, 5000, nan, nan, nan, nan, nan, 0, AirSpectrum(kAirBandCount, 0.4),
                      {},   {}, 12};
    if (radiance) path.radiance_w_m2_sr_um = AirSpectrum(kAirBandCount, 3.5);
    WeatherSpec w = weathers()[0].spec;
    w.imported = std::make_shared<const ImportedPaths>(ImportedPaths{"tape7", {path}});
    const auto e = environment(w);
    Tightness tight;
    std::printf("-- imported %s: largest part of the bound\n",
                radiance ? "with radiance" : "transmittance");
    expect_bounded(*e, lines()[1], "imported", tight);
    EXPECT_FALSE(e->sight_line(lines()[0]).ok());  // not covered
  }
}

TEST(EnvironmentBounds, NoGlitterExceedsThem) {
  // Over a grid of all directions below the horizon, steps of 0.25 deg of elevation (0.7 deg of
  // azimuth): radiance, and its sum.
  for (const double wind_m_s : {0.5, 4.0, 18.0}) {
    WeatherSpec w = weathers()[0].spec;
    w.lower.wind_speed_m_s = wind_m_s;
    const auto e = environment(w);
    Tightness tight;
    std::printf("-- wind %g m/s: largest part of the bound\n", wind_m_s);
    for (std::uint32_t c = 1; c <= 4; ++c) {
      auto look = *e->sight_line(lines()[1]);
      const ViewEnvironment v = (*e->view(lines()[1], std::vector<std::uint32_t>{c}))[0];
      const Vec<Body> to_sun = sunny(kElevationsDeg[c - 1]).sun_direction;
      const std::vector<double> um = wavelengths();
      std::vector<double> largest(um.size(), 0.0), sum(um.size(), 0.0);
      // Reflectances at steps of the incidence.
      constexpr int kCosines = 400;
      std::vector<std::vector<double>> rho(um.size());
      for (std::size_t i = 0; i < um.size(); ++i) {
        for (int k = 0; k <= kCosines; ++k) {
          rho[i].push_back(water_reflectance(sea_water_index(um[i]), k / double{kCosines}));
        }
      }
      constexpr int kElevations = 360, kAzimuths = 512;
      for (int j = 0; j < kElevations; ++j) {
        const double step = 0.5 * M_PI / kElevations, down = (j + 0.5) * step;
        for (int a = 0; a < kAzimuths; ++a) {
          const double turn = 2 * M_PI * (a + 0.5) / kAzimuths;
          const Vec<Body> to_target = {std::cos(down) * std::cos(turn),
                                       std::cos(down) * std::sin(turn), -std::sin(down)};
          const double per_sr = glint_per_sr(to_target, to_sun, wind_m_s);
          if (per_sr <= 0) continue;
          const double cosine = dot(normalized(to_target + to_sun), to_sun);
          const auto k = static_cast<std::size_t>(cosine * kCosines + 0.5);
          for (std::size_t i = 0; i < um.size(); ++i) {
            const double radiance = per_sr * v.sun[i] * rho[i][k];
            largest[i] = std::max(largest[i], radiance);
            sum[i] += radiance * std::cos(down) * step * 2 * M_PI / kAzimuths;
          }
        }
      }
      const std::string where = "sun " + std::to_string(kElevationsDeg[c - 1]);
      tight.expect("mirrored sun", where, largest, look.bounds(c).mirrored_sun);
      tight.expect("mirrored sun, all directions", where, sum, look.bounds(c).mirrored_sun_w_m2_um);
    }
  }
}

TEST(EnvironmentLooks, WhatIsAskedForHasTheBitsOfTheWholeViewAndTheRestIsZero) {
  const Named w = weathers()[0];
  const auto e = environment(w.spec);
  const auto zero = [](const std::vector<double>& spectrum) {
    return std::all_of(spectrum.begin(), spectrum.end(), [](double x) { return x == 0; });
  };
  for (const Environment::Line& l : {lines()[0], lines()[1], lines()[3]}) {
    const auto views = *e->view(l, std::vector<std::uint32_t>{0, 3});
    const ViewEnvironment &night = views[0], &day = views[1];
    for (unsigned mask = 0; mask < 32; ++mask) {
      EffectSet effects = EffectSet::everything(e->conditions(), 1);
      effects.sky = effects.lower = (mask & 1) != 0;
      EffectSet::Sun& use = effects.sun[3];
      use.direct = use.mirrored = (mask & 2) != 0;
      use.diffuse = (mask & 4) != 0;
      use.path = (mask & 8) != 0;
      use.background = (mask & 16) != 0;
      const bool reflected = effects.sky, scattered = reflected && use.diffuse;
      // Nothing is left over from what was asked for before; one at a time also of the conditions.
      const bool alone = l.range_m == 500 && std::has_single_bit(mask);
      const auto own = alone ? environment(w.spec) : nullptr;
      const Environment* fresh = alone ? own.get() : e.get();
      for (const bool with_azimuths : {true, false}) {
        const auto seen = fresh->sight_line(l)->evaluate(3, effects, with_azimuths);
        if (scattered && !with_azimuths) {
          EXPECT_EQ(seen.status().code(), absl::StatusCode::kInvalidArgument);
          continue;
        }
        ASSERT_TRUE(seen.ok()) << seen.status();
        EXPECT_EQ(seen->transmittance, day.transmittance);
        EXPECT_EQ(seen->path_radiance, use.path ? day.path_radiance : night.path_radiance);
        EXPECT_EQ(seen->background_apparent,
                  use.background ? day.background_apparent : night.background_apparent);
        if (use.direct) {
          EXPECT_EQ(seen->sun, day.sun);
          EXPECT_EQ(seen->sun_apparent, day.sun_apparent);
        } else {
          EXPECT_TRUE(zero(seen->sun) && zero(seen->sun_apparent));
        }
        const DirectionNodes& nodes = fresh->nodes(with_azimuths);
        const std::uint32_t per_node = e->nodes().azimuths() / nodes.azimuths();
        const ViewEnvironment& same = scattered ? day : night;
        ASSERT_EQ(seen->around.count(), reflected ? nodes.count() : 2);
        for (std::uint32_t n = 0; n < seen->around.count(); ++n) {
          if (reflected) {
            EXPECT_EQ(seen->around.radiance(n), same.around.radiance(n * per_node));
            EXPECT_EQ(seen->around.apparent(n), same.around.apparent(n * per_node));
          } else {
            EXPECT_TRUE(zero(seen->around.radiance(n)) && zero(seen->around.apparent(n)));
          }
        }
        EXPECT_EQ(seen->sky_interpolation, reflected ? same.sky_interpolation : 0);
        EXPECT_EQ(seen->joined_lines_bound, 0);
      }
    }
  }
}

TEST(EnvironmentLooks, BoundsAndLightOfManyConditionsInAnyOrder) {
  const auto e = environment(weathers()[3].spec);
  const Environment::Line l = lines()[2];
  auto a = *e->sight_line(l), b = *e->sight_line(l);
  const EffectSet everything = EffectSet::everything(e->conditions(), 1);
  const LightBounds first = a.bounds(2);
  const ViewEnvironment after = *a.evaluate(2, everything, true);
  for (const std::uint32_t c : {4u, 0u, 1u}) ASSERT_TRUE(b.evaluate(c, everything, true).ok());
  EXPECT_EQ(apparent_of(b.evaluate(2, everything, true)->around), apparent_of(after.around));
  EXPECT_EQ(b.bounds(2).diffuse_sun, first.diffuse_sun);
  EXPECT_EQ(b.bounds(2).background_sun, first.background_sun);
  EXPECT_EQ(b.evaluate(9, everything, true).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(e->sight_line(line(1000, -5, 0)).ok());
}

// Returns the largest |difference| / reflected of the quarters of a micrometre.
double largest_fraction(const std::vector<double>& is, const std::vector<double>& should,
                        const std::vector<double>& of) {
  const std::vector<double> um = wavelengths();
  std::map<int, std::array<double, 2>> quarter;
  for (std::size_t i = 0; i < um.size(); ++i) {
    auto& q = quarter[static_cast<int>(4 * air_band_lambda_um(*air_band(um[i])))];
    q[0] += is[i] - should[i];
    q[1] += of[i];
  }
  double largest = 0;
  for (const auto& [k, q] : quarter) {
    if (q[1] > 0) largest = std::max(largest, std::abs(q[0]) / q[1]);
  }
  return largest;
}

TEST(EnvironmentLooks, LinesJoinedAtThreeRingsErrByLessThanStated) {
  double tightest = 0;
  for (const double height_m : {10.0, 2000.0}) {
    for (const Named& w : weathers()) {
      const auto e = environment(w.spec, height_m);
      const DirectionNodes& nodes = e->nodes();
      for (const Environment::Line& l :
           {line(500, 5, 0), line(5000, 0.03, 0), line(50e3, 10, 0), line(15e3, 60, 90)}) {
        auto look = *e->sight_line(l);
        for (const std::uint32_t c : {0u, 1u, 3u}) {
          EffectSet effects = EffectSet::everything(e->conditions(), 1);
          const ViewEnvironment all = *look.evaluate(c, effects, true);
          effects.joined_lines = false;
          const ViewEnvironment three = *look.evaluate(c, effects, true);
          const auto all_node = radiance_of(all.around), all_apparent = apparent_of(all.around),
                     three_apparent = apparent_of(three.around);
          EXPECT_EQ(radiance_of(three.around), all_node);
          EXPECT_EQ(three.background_apparent, all.background_apparent);
          EXPECT_EQ(all.joined_lines_bound, 0);
          // Planes reflect with the cosine to their normal, which lies level or straight up.
          double largest = 0;
          for (const Vec<Body> normal :
               {Vec<Body>{0, 0, -1}, Vec<Body>{1, 0, 0}, Vec<Body>{0, -1, 0}, Vec<Body>{0, 0, 1}}) {
            std::vector<std::vector<double>> is, should, of;
            for (std::uint32_t n = 0; n < nodes.count(); ++n) {
              const double cosine = std::max(0.0, dot(nodes.direction(n), normal));
              const auto times = [&](std::vector<double> s) {
                for (double& x : s) x *= cosine;
                return s;
              };
              is.push_back(times(three_apparent[n]));
              should.push_back(times(all_apparent[n]));
              of.push_back(times(all_node[n]));
            }
            largest = std::max(largest, largest_fraction(over_all_directions(nodes, is),
                                                         over_all_directions(nodes, should),
                                                         over_all_directions(nodes, of)));
          }
          // A mirror that sees a single direction.
          double in_one = 0;
          for (std::uint32_t n = 0; n < nodes.count(); ++n) {
            in_one =
                std::max(in_one, largest_fraction(three_apparent[n], all_apparent[n], all_node[n]));
          }
          EXPECT_LE(largest, three.joined_lines_bound) << w.name << " " << l.range_m << " " << c;
          EXPECT_LE(in_one, three.joined_lines_bound) << w.name << " " << l.range_m << " " << c;
          if (three.joined_lines_bound > 1e-6) {
            tightest = std::max(tightest, in_one / three.joined_lines_bound);
          }
          if (height_m < 100 && c == 1) {
            std::printf("%-18s %6g m: planes %.1e, one direction %.1e, stated %.1e\n", w.name,
                        l.range_m, largest, in_one, three.joined_lines_bound);
          }
        }
      }
    }
  }
  std::printf("largest part of what is stated: %.2f\n", tightest);
}

}  // namespace
}  // namespace irsig
