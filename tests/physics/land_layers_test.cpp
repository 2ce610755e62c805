// Layers of an image by what the light of land comes from.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/signature/simulator.h"
#include "core/spectral/band.h"
#include "core/spectral/planck.h"
#include "land_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

const std::vector<float>& layer_of(const SignatureResult& row, ImageLayer which) {
  for (const LayerImage& l : row.layer)
    if (l.layer == which) return l.value;
  ADD_FAILURE() << name_of(which);
  static const std::vector<float> kNone;
  return kNone;
}

constexpr std::uint32_t kSide = 16;
// The corners show land alone.
constexpr std::size_t kCorners[] = {0, kSide - 1, kSide*(kSide - 1), kSide* kSide - 1};

// A picture of a box on flat land, band by band.
std::vector<SignatureResult> picture(bool sun, double emissivity, double land_k,
                                     const Height& height = flat, double elevation_deg = 50) {
  Scene scene = scene_on(elevation_deg, 800, sun, 0, emissivity);
  ImageSpec image;
  image.width_px = image.height_px = kSide;
  image.margin = 1.5;
  image.layer = {ImageLayer::kEmitted,     ImageLayer::kSun,     ImageLayer::kSky,
                 ImageLayer::kSurface,     ImageLayer::kParts,   ImageLayer::kAtSensor,
                 ImageLayer::kLandEmitted, ImageLayer::kLandSky, ImageLayer::kLandSun,
                 ImageLayer::kWithoutAir};
  scene.request.image = image;
  scene.request.condition[0].land_temperature_k = {land_k};
  return view_of(scene, land_of(height, 1000, 10)).row;
}

double air_of(const SignatureResult& row, std::size_t pixel) {
  const auto at = [&](ImageLayer l) { return static_cast<double>(layer_of(row, l)[pixel]); };
  return at(ImageLayer::kAtSensor) - at(ImageLayer::kLandEmitted) - at(ImageLayer::kLandSky) -
         at(ImageLayer::kLandSun);
}

// Rationale: what is left of a pixel of land without emission, sky and sun is the light of the air
// in front of it, which knows neither the land's temperature nor its emissivity. Expected: parts in
// proportion to emissivity and reflectance, and the same remainder.
TEST(LandLayers, PartsFollowEmissivityAndTemperature) {
  const auto grey_land = picture(true, 0.9, 295), paler = picture(true, 0.6, 295),
             warmer = picture(true, 0.9, 310);
  ASSERT_EQ(grey_land.size(), 2u);
  for (std::size_t band = 0; band < 2; ++band)
    for (const std::size_t i : kCorners) {
      const auto at = [&](const std::vector<SignatureResult>& rows, ImageLayer l) {
        return static_cast<double>(layer_of(rows[band], l)[i]);
      };
      const double all = at(grey_land, ImageLayer::kAtSensor);
      EXPECT_GT(at(grey_land, ImageLayer::kLandSky), 0);
      EXPECT_GT(at(grey_land, ImageLayer::kLandSun), 0);
      EXPECT_NEAR(at(paler, ImageLayer::kLandEmitted),
                  0.6 / 0.9 * at(grey_land, ImageLayer::kLandEmitted), 1e-6 * all);
      EXPECT_NEAR(at(paler, ImageLayer::kWithoutAir),
                  0.6 / 0.9 * at(grey_land, ImageLayer::kWithoutAir), 1e-6 * all);
      EXPECT_NEAR(at(paler, ImageLayer::kLandSky), 4 * at(grey_land, ImageLayer::kLandSky),
                  1e-6 * all);
      EXPECT_NEAR(at(paler, ImageLayer::kLandSun), 4 * at(grey_land, ImageLayer::kLandSun),
                  1e-6 * all);
      EXPECT_NEAR(air_of(paler[band], i), air_of(grey_land[band], i), 1e-6 * all);
      EXPECT_NEAR(air_of(warmer[band], i), air_of(grey_land[band], i), 1e-6 * all);
      EXPECT_NEAR(at(warmer, ImageLayer::kLandSky), at(grey_land, ImageLayer::kLandSky),
                  1e-6 * all);
    }
}

// Expected: without air land shows what Planck's law gives it, with air less.
TEST(LandLayers, WithoutAirLandHasItsEmission) {
  const auto rows = picture(true, 0.9, 295);
  const double from_um[] = {8, 3.2}, to_um[] = {12, 5};
  for (std::size_t band = 0; band < 2; ++band) {
    constexpr int kSteps = 4000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
      sum += planck_radiance_w_m2_sr_um(std::lerp(from_um[band], to_um[band], (i + 0.5) / kSteps),
                                        295) *
             (to_um[band] - from_um[band]) / kSteps;
    for (const std::size_t i : kCorners) {
      const auto without = static_cast<double>(layer_of(rows[band], ImageLayer::kWithoutAir)[i]);
      EXPECT_NEAR(without, 0.9 * sum, 1e-3 * sum) << band;
      EXPECT_LT(static_cast<double>(layer_of(rows[band], ImageLayer::kLandEmitted)[i]), without);
    }
  }
}

// Expected: no sunlight of land by night, nor in the shadow of a wall; and the target hides land.
TEST(LandLayers, ShadeAndTargetHideLight) {
  const auto day = picture(true, 0.9, 295), night = picture(false, 0.9, 295);
  // The sun stands 54 deg high; the sensor looks down beside the wall.
  const double towards_deg = 30 + std::atan2(0.5, 0.3) / kRadPerDeg;
  const auto shaded = picture(true, 0.9, 295, wall(120, 400, towards_deg), 88);
  for (std::size_t band = 0; band < 2; ++band) {
    double most = 0, least = 1e9;
    for (std::size_t i = 0; i < std::size_t{kSide} * kSide; ++i) {
      EXPECT_EQ(layer_of(night[band], ImageLayer::kLandSun)[i], 0);
      EXPECT_EQ(layer_of(shaded[band], ImageLayer::kLandSun)[i], 0);
      const auto emitted = static_cast<double>(layer_of(day[band], ImageLayer::kLandEmitted)[i]);
      most = std::max(most, emitted);
      least = std::min(least, emitted);
    }
    EXPECT_GT(most, 0);
    EXPECT_EQ(least, 0) << "a pixel that the target fills";
    // There the target's light is all but the air's.
    const auto& own = day[band];
    for (std::size_t i = 0; i < std::size_t{kSide} * kSide; ++i) {
      if (layer_of(own, ImageLayer::kLandEmitted)[i] > 0) continue;
      EXPECT_GT(layer_of(own, ImageLayer::kWithoutAir)[i], layer_of(own, ImageLayer::kEmitted)[i]);
      EXPECT_GT(layer_of(own, ImageLayer::kEmitted)[i], 0);
    }
  }
}

}  // namespace
}  // namespace irsig
