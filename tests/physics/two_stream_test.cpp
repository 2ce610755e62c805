// Rationale: what clouds and fog scatter is computed by two streams.
// Expected: exact where they must be (isothermal columns, conserved sunlight, layers cut in two),
// and near a Monte Carlo elsewhere. Source: energy; photons followed one by one.
#include "core/atmosphere/two_stream.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace irsig {
namespace {

TEST(TwoStream, IsothermalColumnAboveItsOwnGroundIsABlackBody) {
  const std::vector<StreamLayer> layers = {
      {1e-3, 0.5, 0.4, 2, 2}, {3, 0.9, 0.45, 2, 2}, {1e4, 0.99, 0.4, 2, 2}, {0, 0.9, 0, 2, 2}};
  for (const double albedo : {0.0, 0.3, 0.99}) {
    for (const StreamLight& x : diffuse_light(
             layers,
             {.down_radiance = 2, .up_radiance = 2 * (1 - albedo), .surface_albedo = albedo})) {
      EXPECT_NEAR(x.mean, 2, 1e-12);
      EXPECT_NEAR(x.slope, 0, 1e-12);
    }
  }
}

TEST(TwoStream, SunlightThatNothingAbsorbsIsConserved) {
  for (const double depth : {0.01, 1.0, 30.0, 1e3}) {
    for (const double cosine : {0.02, 0.5, 1.0}) {
      const std::vector<StreamLayer> layer = {{depth, 1, 0.46, 0, 0}};
      const std::vector<StreamLight> light =
          diffuse_light(layer, {.sun_irradiance = 1, .sun_cosine = cosine});
      // Nothing enters: the mean at a boundary is the flux that leaves over 2 pi.
      const double out =
          2 * M_PI * (light.front().mean + light.back().mean) + cosine * std::exp(-depth / cosine);
      EXPECT_NEAR(out, cosine, 5e-6) << depth << " " << cosine;
    }
  }
}

TEST(TwoStream, LayersMayBeCut) {
  const StreamBoundaries boundaries{
      .down_radiance = 0.3, .up_radiance = 0.9, .surface_albedo = 0.2};
  const std::vector<StreamLayer> whole = {{4, 0.8, 0.4, 1, 2}},
                                 cut = {{1, 0.8, 0.4, 1, 1.25}, {3, 0.8, 0.4, 1.25, 2}};
  const auto a = diffuse_light(whole, boundaries), b = diffuse_light(cut, boundaries);
  EXPECT_NEAR(a.front().mean, b.front().mean, 1e-12);
  EXPECT_NEAR(a.back().mean, b.back().mean, 1e-12);
  const StreamBoundaries sun{.surface_albedo = 0.2, .sun_irradiance = 1, .sun_cosine = 0.6};
  const auto c = diffuse_light(whole, sun), d = diffuse_light(cut, sun);
  EXPECT_NEAR(c.front().mean, d.front().mean, 1e-12);
  EXPECT_NEAR(c.back().mean, d.back().mean, 1e-12);
}

// Flux that leaves a layer's bottom when sunlight of irradiance 1 falls on its top, photon by
// photon, Henyey-Greenstein's phase function.
double transmitted_by_photons(double depth, double albedo, double g, double cosine, int photons) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u;
  double out = 0;
  for (int i = 0; i < photons; ++i) {
    double z = 0, mu = cosine, weight = cosine;
    for (;;) {
      z += mu * -std::log(1 - u(random));
      if (z >= depth || z < 0) break;
      weight *= albedo;
      if (weight < 1e-3 * cosine) {
        if (u(random) < 0.5) {
          weight = 0;
          break;
        }
        weight *= 2;
      }
      const double s = (1 - g * g) / (1 - g + 2 * g * u(random));
      const double turn = g == 0 ? 2 * u(random) - 1 : (1 + g * g - s * s) / (2 * g);
      const double azimuth = 2 * M_PI * u(random);
      mu = mu * turn +
           std::sqrt(std::max(0.0, (1 - mu * mu) * (1 - turn * turn))) * std::cos(azimuth);
    }
    if (z >= depth) out += weight;
  }
  return out / photons;
}

TEST(TwoStream, SunlightThroughACloudAsPhotonsHaveIt) {
  struct Case {
    double depth, albedo, g, cosine;
  };
  // 3.7 um: cirrus and water clouds of 20 to 60 g/m2; 10 um.
  for (const Case& c : {Case{2, 0.91, 0.79, 0.8}, Case{5, 0.91, 0.79, 0.5},
                        Case{12, 0.91, 0.79, 0.8}, Case{1, 0.55, 0.95, 0.7}}) {
    const double peak = c.g * c.g;
    const std::vector<StreamLayer> layer = {{c.depth * (1 - c.albedo * peak),
                                             c.albedo * (1 - peak) / (1 - c.albedo * peak),
                                             c.g / (1 + c.g), 0, 0}};
    const double ours =
        2 * M_PI * diffuse_light(layer, {.sun_irradiance = 1, .sun_cosine = c.cosine}).back().mean +
        c.cosine * std::exp(-layer[0].depth / c.cosine);
    const double photons = transmitted_by_photons(c.depth, c.albedo, c.g, c.cosine, 400000);
    EXPECT_NEAR(ours, photons, 0.08 * photons) << c.depth;
  }
}

}  // namespace
}  // namespace irsig
