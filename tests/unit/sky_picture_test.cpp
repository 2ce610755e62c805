// irsig plot --kind sky: the light around a target, by direction.
#include "view/pictures/sky_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/environment/weather_air.h"
#include "core/geo/sun.h"
#include "messages/environment/weather_from_message.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

constexpr std::uint32_t kSide = 101;
constexpr std::size_t kMiddle = kSide / 2;

schema::ResolvedSweep frigate(bool sun, double cover = 0) {
  auto sweep =
      resolved_file(std::filesystem::path(IRSIG_SOURCE_DIR) / "jobs/examples/frigate.toml");
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  sweep->mutable_sweep()->mutable_transport()->set_sun(sun);
  if (cover > 0) {
    schema::Weather& weather = *sweep->mutable_condition(0)->mutable_weather();
    weather.set_cloud_cover(cover);
    schema::CloudLayer& layer = *weather.mutable_cloud();
    layer.set_type("stratus");
    layer.set_phase("water");
    layer.set_base_m(330);
    layer.set_top_m(1000);
    layer.set_water_path_g_m2(200);
    layer.set_effective_radius_um(7.9);
  }
  return *std::move(sweep);
}

schema::Band band(double min_um, double max_um) {
  schema::Band out;
  out.set_name("b");
  out.set_lambda_min_um(min_um);
  out.set_lambda_max_um(max_um);
  out.set_step_um((max_um - min_um) / 20);
  return out;
}

FalseColorPicture drawn(const schema::ResolvedSweep& sweep, const schema::Band& of) {
  const auto picture = draw_sky(sweep, 0, of, kSide);
  EXPECT_TRUE(picture.ok()) << picture.status();
  return *picture;
}

double in_band(const AirSpectrum& spectrum, const schema::Band& of) {
  double sum = 0;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double cm1 = air_band_centre_cm1(b);
    const double low = std::max(of.lambda_min_um(), 1e4 / (cm1 + kAirBandWidthCm1 / 2)),
                 high = std::min(of.lambda_max_um(), 1e4 / (cm1 - kAirBandWidthCm1 / 2));
    sum += std::max(0.0, high - low) * spectrum[b];
  }
  return sum;
}

const PictureLabel& label(const FalseColorPicture& picture, const std::string& text) {
  const auto at = std::find_if(picture.label.begin(), picture.label.end(),
                               [&](const PictureLabel& l) { return l.text == text; });
  EXPECT_NE(at, picture.label.end()) << text;
  return *at;
}

// Rationale: the zenith's pixel is the sky that `irsig show sky` computes along one ray.
// Expected: equal within what band means leave of Planck's function inside a band, 0.5 %.
TEST(SkyPicture, TheZenithIsTheSkyOfItsRay) {
  for (const double cover : {0.0, 0.5}) {
    const schema::ResolvedSweep sweep = frigate(false, cover);
    const schema::Condition& c = sweep.condition(0);
    const auto weather = weather_from_message(c.weather(), c.surroundings());
    ASSERT_TRUE(weather.ok());
    const double height_m = target_height_m(sweep);
    const auto air = WeatherAir::make(*weather, height_m);
    ASSERT_TRUE(air.ok()) << air.status();
    const auto zenith = air->radiance(
        WeatherAir::Sight::kDiffuse,
        [&](const AirProfile& profile) {
          return look(profile, height_m, 0, std::numeric_limits<double>::infinity());
        },
        std::nullopt);
    ASSERT_TRUE(zenith.ok());
    for (const schema::Band& of : {band(3.5, 5), band(8, 12)}) {
      const FalseColorPicture picture = drawn(sweep, of);
      const double expected = in_band(zenith->total_w_m2_sr_um, of);
      EXPECT_NEAR(picture.value[kMiddle * kSide + kMiddle], expected, 0.005 * expected);
      EXPECT_TRUE(std::isnan(picture.value.front()));
      // Warmer towards the horizon.
      EXPECT_GT(picture.value[kMiddle * kSide + 8], picture.value[kMiddle * kSide + kMiddle]);
    }
  }
}

// Rationale: the forward peak, light scattered once and light of two streams of `irsig show sky`
// are those that a run gives a target. Along the sun's azimuth and across it, 20 deg or more from
// it. Expected: within what nodes 15 deg apart leave of the aureole, 6 %; without the forward peak
// the two differ by 10 to 40 %.
TEST(SkyPicture, SunlightThroughACloudIsThatOfItsRay) {
  schema::ResolvedSweep sweep = frigate(true, 1);
  schema::CloudLayer& layer = *sweep.mutable_condition(0)->mutable_weather()->mutable_cloud();
  layer.set_phase("ice");
  layer.set_base_m(10000);
  layer.set_top_m(11000);
  layer.set_water_path_g_m2(6.7);
  layer.set_effective_radius_um(64);
  const schema::Condition& c = sweep.condition(0);
  const schema::Place& place = sweep.sweep().place();
  const auto sun = sun_position(*parse_rfc3339(c.time_utc()), place.latitude_deg(),
                                place.longitude_deg(), place.height_m());
  ASSERT_TRUE(sun.ok());
  const double height_m = target_height_m(sweep);
  const auto air = WeatherAir::make(*weather_from_message(c.weather(), c.surroundings()), height_m);
  ASSERT_TRUE(air.ok());
  const schema::Band of = band(3.5, 4.1);
  const FalseColorPicture picture = drawn(sweep, of);
  struct Sight {
    double zenith_deg, from_sun_deg;
  };
  for (const auto& [zenith_deg, from_sun_deg] :
       {Sight{30, 0}, Sight{45, 0}, Sight{60, 50}, Sight{60, 90}, Sight{60, 180}}) {
    const auto light = air->radiance(
        WeatherAir::Sight::kDiffuse,
        [&](const AirProfile& profile) {
          return look(profile, height_m, zenith_deg, std::numeric_limits<double>::infinity());
        },
        SunPlace{sun->zenith_deg, from_sun_deg, sun->distance_au});
    ASSERT_TRUE(light.ok());
    const double azimuth =
        (sun->azimuth_deg - from_sun_deg - place.heading_deg()) * std::numbers::pi / 180;
    const double r = 0.9 * kSide / std::numbers::sqrt2 *
                     std::sin(zenith_deg * std::numbers::pi / 360);  // radius 0.45 of the side
    const auto column = static_cast<std::size_t>(kSide / 2.0 + r * std::sin(azimuth)),
               row = static_cast<std::size_t>(kSide / 2.0 - r * std::cos(azimuth));
    const double expected = in_band(light->total_w_m2_sr_um, of);
    EXPECT_NEAR(picture.value[row * kSide + column] / expected, 1, 0.06)
        << zenith_deg << " " << from_sun_deg;
  }
}

TEST(SkyPicture, IsLinearInTheCover) {
  const schema::Band of = band(3.5, 5);
  const FalseColorPicture clear = drawn(frigate(true), of), half = drawn(frigate(true, 0.5), of),
                          overcast = drawn(frigate(true, 1), of);
  EXPECT_THAT(half.subtitle, HasSubstr("stratus cover 0.5"));
  EXPECT_THAT(clear.subtitle, HasSubstr("no cloud"));
  for (std::size_t i = 0; i < half.value.size(); ++i) {
    if (std::isnan(half.value[i])) continue;
    EXPECT_NEAR(half.value[i], 0.5F * (clear.value[i] + overcast.value[i]), 1e-6 * half.value[i]);
  }
}

TEST(SkyPicture, IsBrightestAroundTheSun) {
  const FalseColorPicture picture = drawn(frigate(true), band(3.5, 4.1));
  std::size_t brightest = 0;
  for (std::size_t i = 0; i < picture.value.size(); ++i)
    if (picture.value[i] > picture.value[brightest] || std::isnan(picture.value[brightest]))
      brightest = i;
  const PictureLabel& sun = label(picture, "+ sun");
  EXPECT_LT(std::hypot(static_cast<double>(brightest % kSide) - sun.x_px,
                       static_cast<double>(brightest / kSide) - sun.y_px),
            0.08 * kSide);
  const FalseColorPicture night = drawn(frigate(false), band(3.5, 4.1));
  EXPECT_THAT(night.subtitle, HasSubstr("no sun"));
}

TEST(SkyPicture, TheBowIsUp) {
  schema::ResolvedSweep sweep = frigate(false);
  sweep.mutable_sweep()->mutable_place()->set_heading_deg(90);
  const FalseColorPicture picture = drawn(sweep, band(8, 12));
  EXPECT_LT(label(picture, "bow").y_px, 10);
  EXPECT_LT(label(picture, "N").x_px, 10);
  EXPECT_GT(label(picture, "S").x_px, 90);
}

TEST(SkyPicture, NeedsTheEmbeddedAtmosphere) {
  schema::ResolvedSweep sweep = frigate(false);
  sweep.mutable_sweep()->mutable_air()->set_model("vacuum");
  const auto picture = draw_sky(sweep, 0, band(8, 12), kSide);
  EXPECT_EQ(picture.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(picture.status().message()), HasSubstr("air.model = \"atmosphere\""));
}

}  // namespace
}  // namespace irsig
