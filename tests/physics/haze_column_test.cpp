// Rationale: what haze scatters more than once is integrated along a few directions.
// Expected: exact where it must be (isothermal columns, no particles), light at the zenith without
// an azimuth, and skies of homogeneous haze as photons followed one by one have them. Source: a
// Monte Carlo below, which scatters by Henyey and Greenstein's full phase function.
#include "core/atmosphere/haze_column.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/atmosphere/path_sums.h"
#include "core/geo/frames.h"

namespace irsig {
namespace {

TEST(HazeColumn, OfIsothermalAirIsABlackBody) {
  const std::vector<StreamLayer> layers = {
      {1e-3, 0.5, 0.7, 2, 2}, {3, 0.9, 0.8, 2, 2}, {0, 0.9, 0, 2, 2}, {0.2, 0, 0, 2, 2}};
  for (const double albedo : {0.0, 0.3}) {
    HazeBoundaries boundaries{.up_radiance = 2 * (1 - albedo), .surface_albedo = albedo};
    boundaries.down_radiance.fill(2);
    for (const HazeSource& source : haze_sources(layers, boundaries)) {
      EXPECT_NEAR(source.harmonic[0], 2, 1e-9);
      for (std::size_t i = 1; i < HazeHarmonics::kCount; ++i)
        EXPECT_NEAR(source.harmonic[i], 0, 1e-9) << i;
      EXPECT_EQ(source.peak, 0);
    }
  }
}

TEST(HazeColumn, WithoutParticlesAndGroundThereIsNoSunlight) {
  const std::vector<StreamLayer> layers = {{0.4, 0, 0.5, 0, 0}, {0.1, 0, 0, 0, 0}};
  const std::vector<double> beam = {1, std::exp(-0.8), std::exp(-1.0)};
  for (const HazeSource& source : haze_sources(layers, {.beam = beam, .sun_cosine = 0.5})) {
    for (const double x : source.harmonic) EXPECT_NEAR(x, 0, 1e-12);
    EXPECT_EQ(source.peak, 0);
  }
}

TEST(HazeColumn, HarmonicsAreOrthonormal) {
  // Over all cosines: the integral of the square is 2 / (2 l + 1).
  for (std::size_t m = 0; m < kHazeModes; ++m)
    for (std::size_t a = m; a < kHazeMoments; ++a)
      for (std::size_t b = m; b < kHazeMoments; ++b) {
        double sum = 0;
        constexpr int kSteps = 3000;
        for (int i = 0; i < kSteps; ++i) {
          const HazeHarmonics at(2 * (i + 0.5) / kSteps - 1);
          sum += at[HazeHarmonics::first(m) + a - m] * at[HazeHarmonics::first(m) + b - m] * 2 /
                 kSteps;
        }
        EXPECT_NEAR(sum, a == b ? 2.0 / static_cast<double>(2 * a + 1) : 0, 1e-4);
      }
}

// A homogeneous layer above a dim ground, seen from below.
struct Sky {
  double depth, asymmetry, sun_cosine, cosine, azimuth;
  static constexpr double kAlbedo = 0.95, kGround = 0.05;

  [[nodiscard]] double to_sun() const {
    return cosine * sun_cosine + std::sqrt(1 - cosine * cosine) *
                                     std::sqrt(1 - sun_cosine * sun_cosine) * std::cos(azimuth);
  }

  struct Light {
    double once = 0, all = 0;
  };
  [[nodiscard]] Light by_photons() const;
  // Light scattered more than once, integrated along the line of sight.
  [[nodiscard]] double again() const;
};

Sky::Light Sky::by_photons() const {
  constexpr int kMany = 30000;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u;
  const double sun_sine = std::sqrt(1 - sun_cosine * sun_cosine), g = asymmetry;
  Light sum;
  for (int i = 0; i < kMany; ++i) {
    const double sine = std::sqrt(1 - cosine * cosine);
    Vec<Body> d{sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
    double below = depth;  // depth below the top
    for (bool first = true;; first = false) {
      below += std::log(1 - u(random)) * d.z;
      if (below < 0) break;
      if (below >= depth) {
        if (u(random) > kGround) break;
        sum.all += std::exp(-depth / sun_cosine) * sun_cosine / M_PI;
        const double up = std::sqrt(u(random)), turn = 2 * M_PI * u(random);
        d = {std::sqrt(1 - up * up) * std::cos(turn), std::sqrt(1 - up * up) * std::sin(turn), up};
        below = depth;
        continue;
      }
      if (u(random) > kAlbedo) break;
      const double lit = std::exp(-below / sun_cosine) *
                         henyey_greenstein_per_sr(g, d.x * sun_sine + d.z * sun_cosine);
      sum.all += lit;
      if (first) sum.once += lit;
      const double s = (1 - g * g) / (1 - g + 2 * g * u(random)), turn = 2 * M_PI * u(random);
      const double c = (1 + g * g - s * s) / (2 * g), e = std::sqrt(std::max(0.0, 1 - c * c));
      const Vec<Body> axis = std::abs(d.z) < 0.9 ? Vec<Body>{0, 0, 1} : Vec<Body>{1, 0, 0};
      const Vec<Body> p = normalized(cross(d, axis)), q = cross(d, p);
      d = normalized(c * d + e * std::cos(turn) * p + e * std::sin(turn) * q);
    }
  }
  return {sum.once / kMany, sum.all / kMany};
}

double Sky::again() const {
  constexpr std::size_t kLayers = 24;
  const double step = depth / kLayers;
  std::vector<double> beam = {1};
  for (std::size_t k = 1; k <= kLayers; ++k)
    beam.push_back(std::exp(-static_cast<double>(k) * step / sun_cosine));
  const std::vector<HazeSource> source =
      haze_sources(std::vector<StreamLayer>(kLayers, {step, kAlbedo, asymmetry, 0, 0}),
                   {.surface_albedo = kGround, .beam = beam, .sun_cosine = sun_cosine});
  const HazeHarmonics harmonic(-cosine);
  const auto towards = [&](const HazeSource& of) {
    double sum = of.peak * henyey_greenstein_per_sr(of.peak_asymmetry, to_sun());
    for (std::size_t m = 0; m < kHazeModes; ++m)
      for (std::size_t l = m; l < kHazeMoments; ++l) {
        const std::size_t i = HazeHarmonics::first(m) + l - m;
        sum += (m == 0 ? 1 : 2) * std::cos(static_cast<double>(m) * azimuth) * of.harmonic[i] *
               harmonic[i];
      }
    return sum;
  };
  double sum = 0;
  for (std::size_t k = 0; k < kLayers; ++k) {
    const double near = (depth - static_cast<double>(k + 1) * step) / cosine,
                 far = (depth - static_cast<double>(k) * step) / cosine;
    sum += kAlbedo * 0.5 * (towards(source[k]) + towards(source[k + 1])) *
           (std::exp(-near) - std::exp(-far));
  }
  return sum;
}

// Four terms of azimuth leave the largest errors where sun and sight lie low, opposite each other.
TEST(HazeColumn, SkiesShineAsPhotonsHaveIt) {
  for (const double depth : {0.5, 2.0})
    for (const double g : {0.5, 0.75})
      for (const double sun : {0.7, 0.26})
        for (const double cosine : {1.0, 0.7, 0.17})
          for (const double azimuth : {0.3, 1.5, 3.0}) {
            const Sky sky{depth, g, sun, cosine, azimuth};
            const Sky::Light light = sky.by_photons();
            const double ours = light.once + sky.again();
            EXPECT_NEAR(ours, light.all, 0.18 * light.all)
                << depth << " " << g << " " << sun << " " << cosine << " " << azimuth;
          }
}

}  // namespace
}  // namespace irsig
