// A job whose path weights overflow, or whose radiance no blackbody has, must fail and say why: not
// store what is left, nor end the worker's process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "jobs/keys/expand.h"
#include "runner/job_runner.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

// A ship whose BRDF multiplies light by 3e30 at each reflection, at 1 K: no light at 3-5 um, so
// that nothing but the weights themselves is out of range.
schema::ResolvedSweep absurd_ship(double brdf_per_sr) {
  auto sweep = resolved_file(IRSIG_SOURCE_DIR "/jobs/examples/disk.toml");
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  schema::Sweep& asked = *sweep->mutable_sweep();
  asked.mutable_model()->Clear();
  asked.mutable_model()->set_generate("frigate");
  asked.mutable_model()->set_triangles(4000);
  asked.mutable_part(0)->clear_match();
  asked.mutable_part(0)->add_match("*");
  schema::Material& material = *asked.mutable_material(0);
  const std::string name = material.name();
  material.Clear();
  material.set_name(name);
  material.set_kind("tabulated");
  material.set_allow_energy_gain(true);
  schema::BrdfTable& table = *material.mutable_brdf();
  table.add_lambda_um(4);
  for (const double zenith_deg : {0.0, 90.0}) {
    table.add_theta_i_deg(zenith_deg);
    table.add_theta_r_deg(zenith_deg);
    table.add_phi_deg(2 * zenith_deg);
  }
  for (int i = 0; i < 8; ++i) table.add_brdf_per_sr(brdf_per_sr);
  sweep->mutable_condition(0)->set_part_temperature_k(0, 1);
  asked.mutable_transport()->set_max_reflections(6);
  asked.mutable_accuracy()->clear_relative_error();
  asked.mutable_accuracy()->set_samples_per_replicate(256);
  asked.mutable_output()->set_thumbnail_px(0);
  return *std::move(sweep);
}

absl::StatusOr<schema::JobResult> first_job(const schema::ResolvedSweep& sweep) {
  const auto runner = JobRunner::create(sweep, {}, {});
  if (!runner.ok()) return runner.status();
  return (*runner)->run(expand_jobs(sweep, physics_version()).front());
}

TEST(FailedJob, SaysHowManyWeightsWereNotFinite) {
  const auto result = first_job(absurd_ship(1e30));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInternal) << result.status();
  EXPECT_THAT(std::string(result.status().message()),
              testing::ContainsRegex("[1-9][0-9]* path weights were not finite"));
}

// The weights overflow at the second reflection, which only the profile follows.
TEST(FailedJob, SoDoesAProfile) {
  schema::ResolvedSweep sweep = absurd_ship(1e30);
  sweep.mutable_sweep()->mutable_transport()->set_max_reflections(0);
  EXPECT_TRUE(first_job(sweep).ok());
  schema::Profile& profile = *sweep.mutable_sweep()->add_profile();
  profile.set_name("deck");
  for (const double at_m : {0.0, 0.0, -5.0}) profile.add_at_m(at_m);
  profile.set_footprint_width_m(100);
  profile.set_footprint_height_m(20);
  profile.add_reflections(6);
  profile.set_samples(8192);
  const auto result = first_job(sweep);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInternal) << result.status();
  EXPECT_THAT(std::string(result.status().message()),
              testing::ContainsRegex("profile.0.: [1-9][0-9]* path weights were not finite"));
}

// Under a sky of 1e25 W/(m2 sr um) a grey ship is brighter than a blackbody of 1e12 K.
TEST(FailedJob, NamesARadianceThatNoBlackbodyHas) {
  schema::ResolvedSweep sweep = absurd_ship(0.2);
  sweep.mutable_condition(0)->mutable_surroundings()->set_sky_radiance_w_m2_sr_um(1e25);
  const auto result = first_job(sweep);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInternal) << result.status();
  EXPECT_THAT(
      std::string(result.status().message()),
      testing::ContainsRegex("source_radiance_temperature_k is not a finite number: no blackbody "
                             "has a radiance of [0-9.]+e.2[0-9] W"));
}

TEST(FailedJob, TheSameShipOfASaneMaterialDoesNotFail) {
  const auto result = first_job(absurd_ship(0.2));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->guarded_nonfinite(), 0u);
}

}  // namespace
}  // namespace irsig
