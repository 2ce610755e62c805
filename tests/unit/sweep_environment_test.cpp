// Tests the way from a resolved sweep with the embedded atmosphere to the core's values.
#include "messages/environment/sweep_environment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::Each;
using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::Lt;

schema::ResolvedSweep frigate(bool sun) {
  auto sweep =
      resolved_file(std::filesystem::path(IRSIG_SOURCE_DIR) / "jobs/examples/frigate.toml");
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  sweep->mutable_sweep()->mutable_transport()->set_sun(sun);
  return *std::move(sweep);
}

TEST(SweepEnvironment, TheWeatherIsTheConditions) {
  const schema::ResolvedSweep sweep = frigate(false);
  const auto weather =
      weather_from_message(sweep.condition(2).weather(), sweep.condition(2).surroundings());
  ASSERT_TRUE(weather.ok()) << weather.status();
  const AirLevel& surface = weather->air.profile.level.front();
  EXPECT_NEAR(surface.temperature_k, 298.15, 1e-9);
  EXPECT_NEAR(surface.pressure_pa, 101300, 1e-6);
  EXPECT_NEAR(relative_humidity_percent(surface), 80, 1e-6);
  EXPECT_EQ(weather->air.aerosol.kind, AerosolKind::kMaritime);
  EXPECT_EQ(weather->air.aerosol.visibility_m, 23000);
  EXPECT_EQ(weather->air.co2_ppmv, 425);
  EXPECT_EQ(weather->lower.kind, SurfaceBoundary::Kind::kRoughSea);
  EXPECT_EQ(weather->lower.temperature_k, 298.15);
  EXPECT_EQ(weather->lower.wind_speed_m_s, 5);
  EXPECT_EQ(weather->imported, nullptr);
  EXPECT_TRUE(weather->refraction);
}

TEST(SweepEnvironment, EveryAerosolHasItsName) {
  ASSERT_EQ(aerosol_names().size(), 8U);
  EXPECT_EQ(*aerosol_named("none"), AerosolKind::kNone);
  EXPECT_EQ(*aerosol_named("rural"), AerosolKind::kRural);
  EXPECT_EQ(*aerosol_named("urban"), AerosolKind::kUrban);
  EXPECT_EQ(*aerosol_named("maritime"), AerosolKind::kMaritime);
  EXPECT_EQ(*aerosol_named("tropospheric"), AerosolKind::kTropospheric);
  EXPECT_EQ(*aerosol_named("navy_maritime"), AerosolKind::kNavyMaritime);
  EXPECT_EQ(*aerosol_named("advection_fog"), AerosolKind::kAdvectionFog);
  EXPECT_EQ(*aerosol_named("radiation_fog"), AerosolKind::kRadiationFog);
  EXPECT_FALSE(aerosol_named("smog").ok());
}

TEST(SweepEnvironment, SeesThroughTheAirOfEachSeason) {
  const schema::ResolvedSweep sweep = frigate(false);
  EXPECT_EQ(target_height_m(sweep), 6.4);
  // Air and sky follow what is raised.
  schema::ResolvedSweep raised = sweep;
  for (const double m : {0.0, 0.0, 1000.0})
    raised.mutable_sweep()->mutable_model()->add_offset_m(m);
  EXPECT_EQ(target_height_m(raised), 1006.4);
  // In the air it is the reference point.
  EXPECT_EQ(air_point_height_m(sweep, 0), 6.4);
  EXPECT_EQ(air_point_height_m(sweep, 0.5), 1);
  EXPECT_EQ(air_point_height_m(sweep, 3000), 3000);
  const auto environment = environment_of(sweep, std::vector<double>{4.0, 10.0});
  ASSERT_TRUE(environment.ok()) << environment.status();
  EXPECT_EQ((*environment)->conditions(), 3U);
  const std::vector<std::uint32_t> all = {0, 1, 2};
  const auto seen = (*environment)
                        ->view({.range_m = 5000,
                                .elevation_deg = 30,
                                .direction = Vec<Body>{0.8660254037844386, 0, -0.5},
                                .behind = BackgroundDirections({0.5f})},
                               all);
  ASSERT_TRUE(seen.ok()) << seen.status();
  for (const ViewEnvironment& season : *seen) {
    EXPECT_THAT(season.transmittance, Each(Gt(0.1)));
    EXPECT_THAT(season.transmittance, Each(Lt(1.0)));
    EXPECT_THAT(season.path_radiance, Each(Gt(0.0)));
    EXPECT_THAT(season.sun, Each(0.0));
  }
  // Humid summer air is the least transparent at 10 um.
  EXPECT_GT((*seen)[0].transmittance[1], (*seen)[2].transmittance[1] + 0.1);
}

TEST(SweepEnvironment, RefusesWavelengthsWithoutAbsorption) {
  const auto environment = environment_of(frigate(false), std::vector<double>{1.0});
  EXPECT_EQ(environment.status().code(), absl::StatusCode::kOutOfRange);
}

TEST(SweepEnvironment, SpectraJumpInsideTheBandsOnly) {
  const std::vector<double> breaks_um = spectral_breaks_um(frigate(false));
  ASSERT_GT(breaks_um.size(), 100U);
  for (std::size_t i = 0; i < breaks_um.size(); ++i) {
    const double um = breaks_um[i];
    EXPECT_TRUE((um > 2.9 && um < 5.1) || (um > 7.9 && um < 12.1)) << um;
    if (i > 0) {
      EXPECT_GT(um, breaks_um[i - 1]);
    }
  }
  schema::ResolvedSweep vacuum = frigate(false);
  vacuum.mutable_sweep()->mutable_air()->set_model("vacuum");
  EXPECT_THAT(spectral_breaks_um(vacuum), IsEmpty());
}

}  // namespace
}  // namespace irsig
