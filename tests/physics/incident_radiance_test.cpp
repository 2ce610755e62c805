// Rationale: light from around the target is never written down by wavelength; integrals, sums over
// directions and the bound of other places of the target are made in the air's bands. Expected:
// what the written-down spectra give, to rounding; of the bound at least that, and the same where
// there is no sun. Source: the spectra of IncidentRadiance, summed here one by one; that these are
// the sky's is environment_nodes_test.cpp's to show.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/environment/environment.h"
#include "tests/physics/around_spectra.h"

namespace irsig {
namespace {

using Spectra = std::vector<std::vector<double>>;

std::vector<double> around_wavelengths() {
  std::vector<double> um;
  for (double x = 3.4; x < 5; x += 0.013) um.push_back(x);
  for (double x = 8; x < 12; x += 0.04) um.push_back(x);
  return um;
}

ConditionEnvironment around_sunny(double zenith_deg, std::uint32_t weather) {
  const double z = zenith_deg * M_PI / 180;
  return {weather, true, {std::sin(z) * 0.6, std::sin(z) * 0.8, -std::cos(z)}, 1};
}

WeatherSpec around_weather(AerosolKind aerosol, double visibility_m, SurfaceBoundary lower) {
  AtmosphereSpec spec{afgl_profile(AfglProfile::kMidlatitudeSummer), {}};
  spec.aerosol.kind = aerosol;
  spec.aerosol.visibility_m = visibility_m;
  return {spec, true, lower, nullptr};
}

// Clear air over a rough sea, fog over a grey sea, ground; high sun, sun on the horizon, night.
struct Scenes {
  std::unique_ptr<const Environment> environment;
  std::vector<ViewEnvironment> seen;
  Scenes() {
    const std::vector<WeatherSpec> weathers = {
        around_weather(AerosolKind::kMaritime, 23e3, {SurfaceBoundary::Kind::kRoughSea, 293, 1, 6}),
        around_weather(AerosolKind::kRadiationFog, 300,
                       {SurfaceBoundary::Kind::kGreySea, 290, 0.9, 0}),
        around_weather(AerosolKind::kNone, 0, {SurfaceBoundary::Kind::kGround, 300, 0.8, 0})};
    std::vector<ConditionEnvironment> conditions;
    for (const std::uint32_t w : {0u, 1u, 2u}) {
      ConditionEnvironment night;
      night.weather = w;
      conditions.insert(conditions.end(), {around_sunny(30, w), around_sunny(89.9, w), night});
    }
    environment = *Environment::make(weathers, conditions, 10, around_wavelengths());
    Environment::Line line{4000, 8, body_from_aspect(30, 8), BackgroundDirections({0.1f, 0.2f})};
    line.end = {{3960, 40}, {4040, 2}};
    std::vector<std::uint32_t> all;
    for (std::uint32_t c = 0; c < conditions.size(); ++c) all.push_back(c);
    seen = *environment->view(line, all);
  }
};
const Scenes& scenes() {
  static const Scenes made;
  return made;
}

struct Random {
  std::mt19937_64 engine{7};
  double operator()() { return std::uniform_real_distribution<double>(0, 1)(engine); }
  std::vector<double> list(std::size_t n) {
    std::vector<double> out(n);
    for (double& x : out) x = (*this)();
    return out;
  }
};

TEST(IncidentRadiance, IntegralsAreThoseOfTheSpectra) {
  Random random;
  const std::size_t first = 5, columns = 3;
  for (std::size_t c = 0; c < scenes().seen.size(); ++c) {
    const IncidentRadiance& around = scenes().seen[c].around;
    const std::vector<double> weight = random.list(120), function = random.list(120 * columns);
    for (const bool plain : {true, false}) {
      const auto in =
          around.integrals(first, weight, plain ? nullptr : function.data(), plain ? 1 : columns);
      const auto expect = [&](const Spectra& spectra, const std::vector<double>& is) {
        const std::size_t n = plain ? 1 : columns;
        ASSERT_EQ(is.size(), spectra.size() * n);
        for (std::size_t node = 0; node < spectra.size(); ++node)
          for (std::size_t k = 0; k < n; ++k) {
            double sum = 0;
            for (std::size_t i = 0; i < weight.size(); ++i)
              sum += weight[i] * (plain ? 1 : function[i * columns + k]) * spectra[node][first + i];
            ASSERT_NEAR(is[node * n + k], sum, 1e-12 * sum) << c << " node " << node;
          }
      };
      expect(radiance_of(around), in.source);
      expect(apparent_of(around), in.apparent);
      expect(interpolation_of(around), in.interpolation);
    }
  }
}

TEST(IncidentRadiance, BinsAreThoseOfTheSpectra) {
  Random random;
  const std::size_t first = 5;
  const std::vector<std::size_t> bin_first = {0, 1, 40, 41, 119, 120};
  for (std::size_t c = 0; c < scenes().seen.size(); ++c)
    for (const bool sky : {true, false}) {  // the other side dark
      const IncidentRadiance around =
          sky ? scenes().seen[c].around : scenes().seen[c].around.only(false, true);
      const std::vector<double> weight = random.list(120);
      const IncidentRadiance::Binned binned = around.binned(first, weight, bin_first);
      const auto expect = [&](const Spectra& spectra, const std::vector<double>& is) {
        const std::size_t bins = bin_first.size() - 1;
        ASSERT_EQ(is.size(), spectra.size() * bins);
        for (std::size_t node = 0; node < spectra.size(); ++node)
          for (std::size_t k = 0; k < bins; ++k) {
            double sum = 0;
            for (std::size_t i = bin_first[k]; i < bin_first[k + 1]; ++i)
              sum += weight[i] * spectra[node][first + i];
            ASSERT_NEAR(is[node * bins + k], sum, 1e-12 * sum) << c << " node " << node;
          }
      };
      expect(radiance_of(around), binned.source);
      expect(apparent_of(around), binned.apparent);
    }
}

TEST(IncidentRadiance, SumsOverDirectionsAreThoseOfTheSpectra) {
  Random random;
  const std::size_t first = 3, stride = 2;
  for (std::size_t c = 0; c < scenes().seen.size(); ++c) {
    const IncidentRadiance& around = scenes().seen[c].around;
    const Spectra here = radiance_of(around), seen = apparent_of(around);
    const std::uint32_t sky = scenes().environment->nodes().sky();
    std::vector<std::vector<double>> weights;
    std::vector<IncidentRadiance::Weights> lists;
    for (int list = 0; list < 3; ++list) weights.push_back(random.list(around.count() * stride));
    for (std::size_t k = 0; k < weights[1].size(); k += 3) weights[1][k] = 0;  // none met
    weights.emplace_back(around.count() * stride, 0.0);  // one direction alone on each side
    weights.back()[0] = weights.back()[sky * stride] = 1;
    for (const auto& w : weights) lists.push_back({w.data(), stride});
    // Bands are taken sixteen at once, and the rest one by one.
    for (const auto& [above, n] : {std::pair{true, std::size_t{200}},
                                   {false, std::size_t{200}},
                                   {true, std::size_t{7}},
                                   {false, std::size_t{23}}}) {
      const auto sums = around.sums(above, lists, first, n);
      for (std::size_t list = 0; list < lists.size(); ++list)
        for (std::size_t i = 0; i < n; ++i) {
          double radiance = 0, apparent = 0;
          for (std::uint32_t k = above ? 0 : sky; k < (above ? sky : around.count()); ++k) {
            radiance += weights[list][k * stride] * here[k][first + i];
            apparent += weights[list][k * stride] * seen[k][first + i];
          }
          ASSERT_NEAR(sums[list].radiance[i], radiance, 1e-12 * radiance) << c;
          ASSERT_NEAR(sums[list].apparent[i], apparent, 1e-12 * apparent) << c;
        }
    }
  }
}

// The air of other places of the target, as spectra have it, and as the bands bound it.
TEST(IncidentRadiance, ChangesOfTheAirAreBoundedAndExactAtNight) {
  Random random;
  const std::size_t first = 4, n = 210;
  for (std::size_t c = 0; c < scenes().seen.size(); ++c) {
    const ViewEnvironment& e = scenes().seen[c];
    ASSERT_EQ(e.end.size(), 2u);
    ASSERT_EQ(e.end_change.size(), 2u);
    const Spectra here = radiance_of(e.around);
    const std::vector<double> weight = random.list(n);
    std::vector<double> of_node = random.list(here.size());
    std::fill_n(of_node.begin(), 24, 0.0);  // a ring at least that no path met
    double largest = 0, total = 0;
    for (std::size_t k = 0; k < here.size(); ++k)
      for (std::size_t i = 0; i < n; ++i) {
        double most = 0;
        for (const AirPath& end : e.end)
          most = std::max(
              most, std::abs(here[k][first + i] *
                                 (end.transmittance[first + i] - e.transmittance[first + i]) +
                             end.path_radiance_w_m2_sr_um[first + i] - e.path_radiance[first + i]));
        largest += weight[i] * of_node[k] * most;
        total += weight[i] * of_node[k] * here[k][first + i];
      }
    const double bound = e.around.changed(e.end_change, first, weight, of_node);
    const double by_node =
        e.around.changed(e.end_change, first, weight, [&](std::uint32_t node, std::span<double> w) {
          std::fill(w.begin(), w.end(), of_node[node]);
          return true;
        });
    EXPECT_NEAR(by_node, bound, 1e-9 * bound) << c;
    EXPECT_GE(bound, largest * (1 - 1e-9)) << c;
    const bool night = c % 3 == 2;
    EXPECT_LE(bound, largest * (night ? 1 + 1e-9 : 1.5)) << c;
    EXPECT_GT(largest, 1e-6 * total) << c;
  }
}

TEST(IncidentRadiance, SidesThatAreNotWantedAreDark) {
  const ViewEnvironment& e = scenes().seen[0];
  const std::uint32_t sky = scenes().environment->nodes().sky();
  const std::vector<double> weight(50, 1.0), of_node(e.around.count(), 1.0);
  const IncidentRadiance lower = e.around.only(false, true);
  const auto in = lower.integrals(0, weight, nullptr, 1);
  for (std::uint32_t k = 0; k < lower.count(); ++k) {
    EXPECT_EQ(in.source[k] > 0 && in.apparent[k] > 0 && in.interpolation[k] > 0, k >= sky) << k;
    EXPECT_EQ(lower.radiance(k)[3] > 0, k >= sky);
  }
  const std::vector<IncidentRadiance::Weights> ones{{of_node.data(), 1}};
  const auto of_sky = lower.sums(true, ones, 0, 50), of_lower = lower.sums(false, ones, 0, 50);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(of_sky[0].radiance[i], 0);
    EXPECT_GT(of_lower[0].radiance[i], 0);
  }
  // Where nothing shines the path's own light is what changes.
  const IncidentRadiance none = e.around.only(false, false);
  double largest = 0;
  for (std::size_t i = 0; i < 50; ++i) {
    double most = 0;
    for (const AirPath& end : e.end)
      most = std::max(most, std::abs(end.path_radiance_w_m2_sr_um[i] - e.path_radiance[i]));
    largest += most;
  }
  largest *= static_cast<double>(of_node.size());
  const double bound = none.changed(e.end_change, 0, weight, of_node);
  EXPECT_GE(bound, largest * (1 - 1e-9));
  EXPECT_LE(bound, 1.5 * largest);
  // The bound is exact to the last bit: thermal light and the sun's each by its largest change in a
  // band.
  const IncidentRadiance::Shapes& shapes = none.shapes();
  double expected = 0;
  for (std::size_t i = 0; i < 50; ++i) {
    double thermal = 0, solar = 0;
    for (const IncidentRadiance::AirChange& change : e.end_change) {
      thermal = std::max(thermal, std::abs(change.path_thermal[shapes.band[i]]));
      solar = std::max(solar, std::abs(change.path_solar[shapes.band[i]]));
    }
    expected += thermal * shapes.thermal[i] + solar * shapes.solar[i];
  }
  expected *= static_cast<double>(of_node.size());
  EXPECT_NEAR(bound, expected, 1e-12 * expected);
  // Dark nodes stay dark.
  EXPECT_EQ(e.around.only(false, true).only(true, true).radiance(0)[3], 0);
  EXPECT_GT(e.around.only(false, true).only(true, true).radiance(sky)[3], 0);
  EXPECT_EQ(e.around.only(true, false).only(true, true).radiance(sky)[3], 0);
}

// The stored sunlight of a condition belongs to no view: it is one object under any line.
TEST(IncidentRadiance, BitsDoNotDependOnWhichViewAsksFirst) {
  const Scenes fresh;
  for (const std::uint32_t c : {1u, 0u, 6u}) {
    const Environment::Line other{900, 40, body_from_aspect(200, 40),
                                  BackgroundDirections({0.5f, 0.8f})};
    const auto again = *fresh.environment->view(other, std::vector<std::uint32_t>{c});
    EXPECT_EQ(radiance_of(again[0].around), radiance_of(scenes().seen[c].around)) << c;
    EXPECT_NE(apparent_of(again[0].around), apparent_of(scenes().seen[c].around)) << c;
  }
}

}  // namespace
}  // namespace irsig
