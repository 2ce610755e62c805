#include "bridge/job_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "jobs/expand.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

schema::ResolvedSweep disk(std::uint32_t thumbnail_px) {
  auto sweep = resolved_file(IRSIG_SOURCE_DIR "/jobs/examples/disk.toml");
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  sweep->mutable_sweep()->mutable_accuracy()->clear_relative_error();
  sweep->mutable_sweep()->mutable_accuracy()->clear_absolute_error_k();
  sweep->mutable_sweep()->mutable_accuracy()->set_samples_per_replicate(64);
  sweep->mutable_sweep()->mutable_output()->set_thumbnail_px(thumbnail_px);
  return *std::move(sweep);
}

absl::StatusOr<schema::JobResult> first_job(const schema::ResolvedSweep& sweep,
                                            const std::optional<ThumbnailEncoder>& encoder) {
  const auto runner = JobRunner::create(sweep, "", encoder);
  if (!runner.ok()) return runner.status();
  return (*runner)->run(expand_jobs(sweep, physics_version()).front());
}

// A name that this program does not know is an error, never the nearest meaning.
TEST(JobRunner, RefusesNamesThatItDoesNotKnow) {
  const auto refused = [](auto change, const char* what) {
    schema::ResolvedSweep sweep = disk(0);
    change(sweep);
    const auto result = first_job(sweep, {});
    EXPECT_TRUE(absl::IsInvalidArgument(result.status())) << what << ": " << result.status();
    EXPECT_THAT(std::string(result.status().message()), HasSubstr(what));
  };
  refused([](auto& s) { s.mutable_sweep()->mutable_air()->set_model("homogenous"); }, "air.model");
  refused([](auto& s) { s.mutable_condition(0)->mutable_surroundings()->set_kind("land"); },
          "surroundings.kind");
  refused([](auto& s) { s.mutable_sweep()->mutable_effects()->set_mode("some"); }, "effects.mode");
  refused(
      [](auto& s) {
        auto& material = *s.mutable_sweep()->mutable_material(0);
        material.set_kind("cook_torrance");
        material.set_masking("smiths");
      },
      "masking");
}

TEST(JobRunner, RefusesThumbnailsThatItCannotEncode) {
  const auto sweep = disk(16);
  ASSERT_TRUE(JobRunner::create(sweep, "").ok()) << "the scene can be tried without an encoder";
  const auto result = first_job(sweep, {});
  EXPECT_EQ(result.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(result.status().message()), HasSubstr("thumbnail_px"));
}

TEST(JobRunner, NeedsNoEncoderWithoutThumbnails) {
  const auto result = first_job(disk(0), {});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_FALSE(result->view().row(0).has_thumbnail());
}

TEST(JobRunner, GivesTheEncoderEveryPixel) {
  std::size_t pixels = 0;
  const auto size = [&](std::uint32_t width_px, std::uint32_t height_px,
                        const std::vector<float>& radiance_w_m2_sr) -> absl::StatusOr<std::string> {
    pixels = radiance_w_m2_sr.size();
    EXPECT_EQ(pixels, std::size_t{width_px} * height_px);
    return "encoded";
  };
  const auto result = first_job(disk(16), ThumbnailEncoder{size, size});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_GT(pixels, 0U);
  EXPECT_EQ(result->view().row(0).thumbnail().png(), "encoded");
  EXPECT_EQ(result->view().row(0).thumbnail().exr(), "encoded");
}

TEST(JobRunner, PassesOnThatTheEncoderFails) {
  const auto fail = [](std::uint32_t, std::uint32_t, const std::vector<float>&) {
    return absl::StatusOr<std::string>(absl::InternalError("no ink"));
  };
  EXPECT_EQ(first_job(disk(16), ThumbnailEncoder{fail, fail}).status().message(), "no ink");
}

std::string state_of(const schema::SignatureRow& row, const std::string& effect) {
  for (const schema::EffectEntry& e : row.effect())
    if (e.effect() == effect) return schema::EffectState_Name(e.state()) + " " + e.reason();
  return "not in the ledger";
}

// Nearly black: what it reflects fits into 5 %.
schema::ResolvedSweep soot(double relative_error) {
  schema::ResolvedSweep sweep = disk(0);
  schema::Accuracy& accuracy = *sweep.mutable_sweep()->mutable_accuracy();
  accuracy.clear_samples_per_replicate();
  accuracy.set_relative_error(relative_error);
  accuracy.set_absolute_error_k(0.05);
  sweep.mutable_sweep()->mutable_transport()->set_max_reflections(3);
  schema::Surroundings around;
  around.set_kind("none");
  around.set_sky_temperature_k(250);
  around.set_lower_radiance_w_m2_sr_um(0);
  for (schema::Condition& c : *sweep.mutable_condition()) *c.mutable_surroundings() = around;
  for (schema::Material& m : *sweep.mutable_sweep()->mutable_material()) {
    const std::string name = m.name();
    m.Clear();
    m.set_name(name);
    m.set_kind("lambert");
    m.set_emissivity(0.9999);
  }
  return sweep;
}

TEST(JobRunner, HasTheEffectsThatTheSweepAsksFor) {
  schema::ResolvedSweep sweep = soot(0.05);
  auto result = first_job(sweep, {});
  ASSERT_TRUE(result.ok()) << result.status();
  const schema::SignatureRow& row = result->view().row(0);
  EXPECT_EQ(state_of(row, "sky_reflected"), "EFFECT_STATE_OFF within_share");
  EXPECT_GT(row.omitted_bound_w_sr(), 0);
  EXPECT_GT(row.absolute_floor_w_sr(), 0);
  EXPECT_EQ(row.reflections(), 0U);
  EXPECT_FALSE(row.effect(0).has_bound_w_sr()) << "not known";
  EXPECT_TRUE(row.effect(0).has_share_w_sr());
  EXPECT_NEAR(row.energy().balance().value(), 1, 1e-3);

  sweep.mutable_sweep()->mutable_effects()->set_mode("all");
  result = first_job(sweep, {});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(state_of(result->view().row(0), "sky_reflected"), "EFFECT_STATE_ON forced");
  EXPECT_EQ(result->view().row(0).omitted_bound_w_sr(), 0);
  EXPECT_GT(result->view().row(0).reflections(), 0U);

  sweep.mutable_sweep()->mutable_effects()->set_mode("only");
  sweep.mutable_sweep()->mutable_effects()->add_only("direct_sun");
  result = first_job(sweep, {});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(state_of(result->view().row(0), "sky_reflected"), "EFFECT_STATE_OFF forced");

  sweep.mutable_sweep()->mutable_effects()->add_only("perspective");
  EXPECT_EQ(first_job(sweep, {}).status().code(), absl::StatusCode::kInvalidArgument);
  sweep.mutable_sweep()->mutable_effects()->set_mode("some");
  EXPECT_EQ(first_job(sweep, {}).status().code(), absl::StatusCode::kInvalidArgument);
}

// What `irsig plan` tries: the effects of the error, another number of samples.
TEST(JobRunner, APilotHasItsOwnNumberOfSamples) {
  schema::ResolvedSweep sweep = soot(0.05);
  for (const std::uint64_t samples : {64U, 2048U}) {
    sweep.mutable_sweep()->mutable_accuracy()->set_samples_per_replicate(samples);
    const auto result = first_job(sweep, {});
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_EQ(result->samples(), samples * result->replicates());
    EXPECT_EQ(state_of(result->view().row(0), "sky_reflected"), "EFFECT_STATE_OFF within_share");
  }
}

// The whole way of the embedded atmosphere: sweep file, weather, environment, signature.
TEST(JobRunner, ComputesThroughTheEmbeddedAtmosphere) {
  auto sweep = resolved_file(IRSIG_SOURCE_DIR "/jobs/examples/frigate.toml");
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  sweep->mutable_sweep()->mutable_model()->set_triangles(2000);
  sweep->mutable_sweep()->mutable_transport()->set_sun(false);
  sweep->mutable_sweep()->mutable_accuracy()->clear_relative_error();
  sweep->mutable_sweep()->mutable_accuracy()->clear_absolute_error_k();
  sweep->mutable_sweep()->mutable_accuracy()->set_samples_per_replicate(64);
  sweep->mutable_sweep()->mutable_output()->set_thumbnail_px(0);
  const auto result = first_job(*sweep, {});
  ASSERT_TRUE(result.ok()) << result.status();
  ASSERT_EQ(result->view().row_size(), 6);
  for (const schema::SignatureRow& row : result->view().row()) {
    EXPECT_GT(row.apparent_intensity_w_sr().value(), 0);
    EXPECT_LT(row.apparent_intensity_w_sr().value(), row.intensity_w_sr().value());
  }
  // Summer's 8-12 um: 5 km of humid air take more than winter's.
  const auto through = [&](int row) {
    return result->view().row(row).apparent_intensity_w_sr().value() /
           result->view().row(row).intensity_w_sr().value();
  };
  EXPECT_LT(through(5), through(1));
}

TEST(JobRunner, AWavelengthWithoutAirIsTheSweepsMistake) {
  auto sweep = resolved_file(IRSIG_SOURCE_DIR "/jobs/examples/frigate.toml");
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  sweep->mutable_sweep()->mutable_band(0)->set_lambda_min_um(2.5);  // past resolve_sweep
  const auto runner = JobRunner::create(*sweep, "");
  EXPECT_EQ(runner.status().code(), absl::StatusCode::kOutOfRange) << runner.status();
  EXPECT_THAT(std::string(runner.status().message()), HasSubstr("air.model: "));
}

}  // namespace
}  // namespace irsig
