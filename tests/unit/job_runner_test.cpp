#include "runner/job_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "core/geo/sun.h"
#include "core/scene/trace/tracer.h"
#include "jobs/keys/expand.h"
#include "runner/heat_outputs.h"
#include "runner/spec_to_request.h"
#include "runner/sweep_temperatures.h"
#include "tests/unit/heated_sweep.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::AllOf;
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
  const auto runner = JobRunner::create(sweep, {}, {}, encoder);
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

// A coordinator may ask a worker for jobs that the sweep does not have. The largest indices could
// be taken for -1, and those of conditions and bands for good ones.
TEST(JobRunner, RefusesJobsOfWhatTheSweepDoesNotHave) {
  const schema::ResolvedSweep sweep = disk(0);
  const auto runner = JobRunner::create(sweep, {}, {});
  ASSERT_TRUE(runner.ok()) << runner.status();
  const auto refused = [&](auto change, const std::string& why) {
    schema::JobSpec job = expand_jobs(sweep, physics_version()).front();
    change(*job.mutable_view());
    const absl::Status status = (*runner)->run(job).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(why));
  };
  for (const std::uint32_t far : {1u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    refused([&](schema::ViewJob& v) { v.set_viewpoint_index(far); }, "asks for viewpoint");
    refused([&](schema::ViewJob& v) { v.set_condition_index(0, far); }, "asks for condition");
    refused([&](schema::ViewJob& v) { v.add_band_index(far); }, "asks for band");
    schema::JobSpec heat;
    heat.mutable_heat()->set_heat(far);
    EXPECT_TRUE(absl::IsInvalidArgument((*runner)->run(heat).status()));
  }
  refused([](schema::ViewJob& v) { v.clear_condition_index(); }, "asks for no condition");
  refused([](schema::ViewJob& v) { v.clear_band_index(); }, "asks for no band");
}

TEST(JobRunner, RefusesThumbnailsThatItCannotEncode) {
  const auto sweep = disk(16);
  ASSERT_TRUE(JobRunner::create(sweep, {}, {}).ok()) << "the scene can be tried without an encoder";
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
  const auto result = first_job(disk(16), ThumbnailEncoder{size, size, size});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_GT(pixels, 0U);
  EXPECT_EQ(result->view().row(0).thumbnail().png(), "encoded");
  EXPECT_EQ(result->view().row(0).thumbnail().exr(), "encoded");
}

TEST(JobRunner, PassesOnThatTheEncoderFails) {
  const auto fail = [](std::uint32_t, std::uint32_t, const std::vector<float>&) {
    return absl::StatusOr<std::string>(absl::InternalError("no ink"));
  };
  EXPECT_EQ(first_job(disk(16), ThumbnailEncoder{fail, fail, fail}).status().message(), "no ink");
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
  EXPECT_EQ(state_of(row, "sky_reflected"), "EFFECT_STATE_OFF within_fraction");
  EXPECT_GT(row.omitted_bound_w_sr(), 0);
  EXPECT_GT(row.absolute_floor_w_sr(), 0);
  EXPECT_EQ(row.reflections(), 0U);
  EXPECT_FALSE(row.effect(0).has_bound_w_sr()) << "not known";
  EXPECT_TRUE(row.effect(0).has_fraction_w_sr());
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

// A pilot of `irsig plan` has the effects of the error, and another number of samples.
TEST(JobRunner, APilotHasItsOwnNumberOfSamples) {
  schema::ResolvedSweep sweep = soot(0.05);
  for (const std::uint64_t samples : {64U, 2048U}) {
    sweep.mutable_sweep()->mutable_accuracy()->set_samples_per_replicate(samples);
    const auto result = first_job(sweep, {});
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_EQ(result->samples(), samples * result->replicates());
    EXPECT_EQ(state_of(result->view().row(0), "sky_reflected"), "EFFECT_STATE_OFF within_fraction");
  }
}

std::string bytes_without_time(schema::JobResult result) {
  result.clear_seconds();
  return result.SerializeAsString();
}

// The scene is built once for sweeps that differ in accuracy and viewpoints alone, and no bit of a
// result shows that. Another material, or a job that failed, and it is built anew.
TEST(JobRunner, KeepsTheSceneForSweepsThatShareIt) {
  auto first = resolved_file(IRSIG_SOURCE_DIR "/jobs/examples/frigate.toml");
  ASSERT_TRUE(first.ok()) << first.status();
  first->mutable_sweep()->mutable_model()->set_triangles(2000);
  first->mutable_sweep()->mutable_accuracy()->set_relative_error(0.05);
  first->mutable_sweep()->mutable_output()->set_thumbnail_px(0);
  first->mutable_sweep()->mutable_uncertainty()->set_emissivity(0.02);
  schema::ResolvedSweep second = *first;
  second.mutable_sweep()->set_name("second");
  second.mutable_sweep()->mutable_accuracy()->set_relative_error(0.02);
  second.mutable_viewpoint()->SwapElements(0, 7);
  schema::ResolvedSweep other = second;
  other.mutable_condition(0)->mutable_weather()->set_wind_speed_m_s(9);
  KeptScene kept;
  const auto run = [&](const schema::ResolvedSweep& sweep, KeptScene* scene) {
    const auto runner = JobRunner::create(sweep, {}, {}, {}, scene);
    EXPECT_TRUE(runner.ok()) << runner.status();
    auto result = (*runner)->run(expand_jobs(sweep, physics_version()).front());
    EXPECT_TRUE(result.ok()) << result.status();
    return bytes_without_time(*std::move(result));
  };
  EXPECT_EQ(run(*first, &kept), run(*first, nullptr));
  EXPECT_EQ(run(second, &kept), run(second, nullptr));
  EXPECT_EQ(kept.scenes(), 1);
  EXPECT_EQ(run(other, &kept), run(other, nullptr));
  EXPECT_EQ(kept.scenes(), 2);
  const auto runner = JobRunner::create(other, {}, {}, {}, &kept);
  ASSERT_TRUE(runner.ok()) << runner.status();
  EXPECT_EQ(kept.scenes(), 2);
  schema::JobSpec wrong = expand_jobs(other, physics_version()).front();
  wrong.mutable_view()->set_viewpoint_index(100000);
  EXPECT_FALSE((*runner)->run(wrong).ok());
  EXPECT_EQ(run(other, &kept), run(other, nullptr));
  EXPECT_EQ(kept.scenes(), 3);
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
  const auto runner = JobRunner::create(*sweep, {}, {});
  EXPECT_EQ(runner.status().code(), absl::StatusCode::kInvalidArgument) << runner.status();
  EXPECT_THAT(std::string(runner.status().message()), HasSubstr("expected a smaller step_um"));
  // A study of steps leaves those out that reach too far, and so needs to know them.
  std::vector<BandGrid> grids(1);
  grids.front().node_um = {2.5};
  EXPECT_EQ(environment_from_sweep(*sweep, grids).status().code(), absl::StatusCode::kOutOfRange);
}

// Makes plates in the plane x = 0, seen from x > 0: 4 m2 from the front, 1 m2 from behind.
constexpr const char* kPlates = R"(
v 0 0 0
v 0 4 0
v 0 4 1
v 0 0 1
v 0 5 0
v 0 6 0
v 0 6 1
v 0 5 1
g front
f 1 2 3 4
g back
f 5 8 7 6
)";

schema::ResolvedSweep plates() {
  schema::ResolvedSweep sweep = disk(0);
  schema::Sweep& asked = *sweep.mutable_sweep();
  asked.mutable_accuracy()->set_samples_per_replicate(512);
  schema::Model& model = *asked.mutable_model();
  model.Clear();
  model.set_file("plates.obj");
  model.set_unit_m(1);
  model.set_forward_axis("+x");
  model.set_up_axis("+z");
  model.set_reference("origin");
  sweep.set_model_file_name("plates.obj");
  sweep.set_model_sha256("plates");
  schema::Part& front = *asked.mutable_part(0);
  front.set_name("front");
  front.clear_match();
  schema::Part& back = *asked.add_part();
  back = front;
  back.set_name("back");
  sweep.mutable_condition(0)->add_part_temperature_k(sweep.condition(0).part_temperature_k(0));
  schema::Viewpoint& view = *sweep.mutable_viewpoint(0);
  view.set_aspect_azimuth_deg(0);
  view.set_aspect_elevation_deg(0);
  view.set_range_m(1000);
  return sweep;
}

absl::StatusOr<schema::JobResult> first_job_of_plates(const schema::ResolvedSweep& sweep) {
  const auto runner = JobRunner::create(sweep, model_alone(sweep, kPlates), {});
  if (!runner.ok()) return runner.status();
  return (*runner)->run(expand_jobs(sweep, physics_version()).front());
}

// The plates with a part whose temperature is computed, "front", at the sweep's one time.
schema::ResolvedSweep heated_plates() {
  schema::ResolvedSweep sweep = plates();
  sweep.mutable_sweep()->mutable_model()->set_accepted_backface_fraction(1);
  compute_temperatures(sweep, 0, 300);
  return sweep;
}

schema::HeatField field_with(const schema::ResolvedSweep& sweep, float kelvin, float error_k) {
  schema::HeatField field;
  field.add_unix_s(unix_seconds(*parse_rfc3339(sweep.condition(0).time_utc())));
  field.set_facets(4);
  for (std::uint32_t f = 0; f < 4; ++f) {
    field.mutable_kelvin()->append(reinterpret_cast<const char*>(&kelvin), sizeof kelvin);
    field.mutable_error_k()->append(reinterpret_cast<const char*>(&error_k), sizeof error_k);
  }
  return field;
}

TEST(JobRunner, AProcessMayBePinnedToLessThanItsMachineHas) {
  const std::string machine = determinism_class();
  const absl::Status unknown = pin_isa("avx");
  EXPECT_TRUE(absl::IsInvalidArgument(unknown)) << unknown;
  EXPECT_EQ(determinism_class(), machine);
  const bool has_avx512 = widest_isa() == TracerIsa::kAvx512;
  EXPECT_EQ(pin_isa("avx512").code(),
            has_avx512 ? absl::StatusCode::kOk : absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(determinism_class(), machine);
  ASSERT_TRUE(pin_isa("sse4.2").ok());
  EXPECT_EQ(widest_isa(), TracerIsa::kSse42);
  EXPECT_THAT(determinism_class(), HasSubstr("/sse4.2/"));
  // Without AVX-512 its reciprocals do not count: two machines that differ in these agree.
  if (has_avx512) {
    EXPECT_NE(machine.substr(machine.size() - 8),
              determinism_class().substr(determinism_class().size() - 8));
  }
}

TEST(JobRunner, ComputesTemperaturesAndThenTheViewsThatNeedThem) {
  const schema::ResolvedSweep sweep = heated_plates();
  const Assets model = model_alone(sweep, kPlates);
  const std::vector<schema::JobSpec> jobs = expand_jobs(sweep, physics_version());
  ASSERT_EQ(jobs.size(), 2U);
  const auto first = JobRunner::create(sweep, model, {});
  ASSERT_TRUE(first.ok()) << first.status();
  const absl::Status too_early = (*first)->run(jobs[1]).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(too_early)) << too_early;
  const auto heat = (*first)->run(jobs[0]);
  ASSERT_TRUE(heat.ok()) << heat.status();
  EXPECT_EQ(heat->job_key(), jobs[0].job_key());
  EXPECT_EQ(heat->determinism_class(), determinism_class());
  schema::HeatField field;
  ASSERT_TRUE(field.ParseFromString(heat->heat().field()));
  EXPECT_EQ(field.unix_s_size(), 1);
  EXPECT_EQ(heat_outputs(sweep, model).value(), HeatOutputs{heat->heat().field()});
  const auto second = JobRunner::create(sweep, model, {heat->heat().field()});
  ASSERT_TRUE(second.ok()) << second.status();
  const auto view = (*second)->run(jobs[1]);
  ASSERT_TRUE(view.ok()) << view.status();
  EXPECT_GT(view->view().row(0).temperature_bound_w_sr(), 0);
  EXPECT_GE((*first)->memory().fixed_bytes, (*second)->memory().fixed_bytes)
      << "tried without temperatures: what they will need at most";
  EXPECT_GT((*first)->memory().heat_bytes, 0);
}

// 310 K of a job and 310 K of the sweep file are the same, but for the error.
TEST(JobRunner, AComputedTemperatureIsWorthAStatedOne) {
  const schema::ResolvedSweep computed = heated_plates();
  schema::ResolvedSweep stated = computed;
  stated.clear_heat();
  stated.mutable_condition(0)->clear_temperature_field();
  stated.mutable_condition(0)->set_part_temperature_k(0, 310);
  const auto row_of = [](const schema::ResolvedSweep& sweep, const HeatOutputs& heat) {
    const auto runner = JobRunner::create(sweep, model_alone(sweep, kPlates), heat);
    EXPECT_TRUE(runner.ok()) << runner.status();
    const auto result = (*runner)->run(expand_jobs(sweep, physics_version()).back());
    EXPECT_TRUE(result.ok()) << result.status();
    return result->view().row(0);
  };
  const auto a = row_of(stated, {});
  const auto b = row_of(computed, {field_with(computed, 310, 0.5).SerializeAsString()});
  EXPECT_NEAR(b.intensity_w_sr().value() / a.intensity_w_sr().value(), 1, 1e-5);
  EXPECT_EQ(a.temperature_bound_w_sr(), 0);
  EXPECT_GT(b.temperature_bound_w_sr(), 0);
}

TEST(JobRunner, RefusesTemperaturesThatAreNotThoseOfTheSweep) {
  const schema::ResolvedSweep sweep = heated_plates();
  const auto refused = [&](const HeatOutputs& heat, const std::string& why) {
    const absl::Status status =
        JobRunner::create(sweep, model_alone(sweep, kPlates), heat).status();
    EXPECT_FALSE(status.ok()) << why;
    EXPECT_THAT(std::string(status.message()), HasSubstr(why));
  };
  const schema::HeatField good = field_with(sweep, 310, 1);
  refused({good.SerializeAsString(), good.SerializeAsString()}, "2 heat jobs for the 1");
  refused({"\xff"}, "cannot be read");
  schema::HeatField other = good;
  other.set_facets(3);
  refused({other.SerializeAsString()}, "of another mesh: of 3 facets, the model has 4");
  other = good;
  other.set_unix_s(0, good.unix_s(0) + 1e-3);
  refused({other.SerializeAsString()}, "there are none at " + sweep.condition(0).time_utc());
}

// Rationale: a facet inside other bodies has no temperature, and views see slivers of it at most.
// Expected: it is taken for as warm as the rest of its part; a view fails where nothing of the part
// is known, and says where the facet is.
TEST(JobRunner, AViewFailsForTheFacetsThatItSees) {
  const schema::ResolvedSweep sweep = heated_plates();
  const auto view = [&](const schema::HeatField& field) {
    const auto runner =
        JobRunner::create(sweep, model_alone(sweep, kPlates), {field.SerializeAsString()});
    EXPECT_TRUE(runner.ok()) << runner.status();
    return (*runner)->run(expand_jobs(sweep, physics_version()).back());
  };
  const auto unknown = view(field_with(sweep, NAN, NAN));
  EXPECT_THAT(std::string(unknown.status().message()),
              AllOf(HasSubstr("the view sees facet "), HasSubstr(" m forward, "),
                    HasSubstr(" m up"), HasSubstr("fewer than 1 of 32 rays leave the body")));
  const auto wide = view(field_with(sweep, 310, 309.5));
  EXPECT_THAT(std::string(wide.status().message()),
              HasSubstr("(310 K +- 309.5 K: the error leaves nothing of it)"));
  // One facet without: as warm as the others, within what they differ by.
  for (std::uint32_t f = 0; f < field_with(sweep, 310, 1).facets(); ++f) {
    schema::HeatField one = field_with(sweep, 310, 1);
    const auto set = [&](std::uint32_t facet, float kelvin) {
      one.mutable_kelvin()->replace(facet * sizeof(float), sizeof(float),
                                    reinterpret_cast<const char*>(&kelvin), sizeof(float));
    };
    const auto whole = view(one);
    set(f, NAN);
    const auto alike = view(one);
    set((f + 1) % 4, 330);
    const auto apart = view(one);
    ASSERT_TRUE(whole.ok() && alike.ok() && apart.ok()) << alike.status() << apart.status();
    const schema::SignatureRow &a = whole->view().row(0), &b = alike->view().row(0),
                               &c = apart->view().row(0);
    EXPECT_NEAR(b.intensity_w_sr().value(), a.intensity_w_sr().value(),
                1e-6 * a.intensity_w_sr().value());
    EXPECT_GT(c.temperature_bound_w_sr(), 0.99 * b.temperature_bound_w_sr());
  }
}

TEST(JobRunner, FailsAViewThatIsSeenFromBehind) {
  schema::ResolvedSweep sweep = plates();
  const absl::Status failed = first_job_of_plates(sweep).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(failed)) << failed;
  for (const char* what : {"% of the silhouette", "two_sided", "--repair", "primary hits",
                           "model.accepted_backface_fraction"})
    EXPECT_THAT(std::string(failed.message()), HasSubstr(what));
  schema::Model& model = *sweep.mutable_sweep()->mutable_model();
  model.set_accepted_backface_fraction(0.18);
  EXPECT_FALSE(first_job_of_plates(sweep).ok());
  model.set_accepted_backface_fraction(0.22);
  const auto accepted = first_job_of_plates(sweep);
  ASSERT_TRUE(accepted.ok()) << accepted.status();
  EXPECT_NEAR(accepted->view().row(0).backface_fraction(), 0.2, 0.01);
  EXPECT_NEAR(accepted->view().row(0).projected_area_m2().value(), 4, 0.05);
  // A part with two sides is seen from both.
  model.clear_accepted_backface_fraction();
  sweep.mutable_sweep()->mutable_part(1)->set_two_sided(true);
  const auto two_sided = first_job_of_plates(sweep);
  ASSERT_TRUE(two_sided.ok()) << two_sided.status();
  EXPECT_EQ(two_sided->view().row(0).backface_fraction(), 0);
  EXPECT_NEAR(two_sided->view().row(0).projected_area_m2().value(), 5, 0.05);
}

// A cube inside out is nothing but back faces, whatever its strata: with a hot part too.
TEST(JobRunner, ACubeInsideOutIsNoResult) {
  constexpr const char* kCube = R"(
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
g front
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
g back
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
)";
  for (const bool hot : {false, true}) {
    schema::ResolvedSweep sweep = plates();
    sweep.mutable_sweep()->mutable_part(1)->set_hot(hot);
    const auto run = [&] {
      const auto runner = JobRunner::create(sweep, model_alone(sweep, kCube), {});
      EXPECT_TRUE(runner.ok()) << runner.status();
      return (*runner)->run(expand_jobs(sweep, physics_version()).front());
    };
    EXPECT_THAT(std::string(run().status().message()), HasSubstr("100 % of the silhouette"));
    sweep.mutable_sweep()->mutable_model()->set_accepted_backface_fraction(1);
    const auto accepted = run();
    ASSERT_TRUE(accepted.ok()) << accepted.status();
    EXPECT_EQ(accepted->view().row(0).backface_fraction(), 1);
    EXPECT_EQ(accepted->view().row(0).intensity_w_sr().value(), 0);
  }
}

TEST(JobRunner, ProposesTwoSidesForSheets) {
  schema::ResolvedSweep sweep = plates();
  const auto warnings = [&](const char* model) {
    return JobRunner::create(sweep, model_alone(sweep, model), {}).value()->warnings();
  };
  const std::vector<Problem> both = warnings(kPlates);
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[1].key, "part[1]");
  EXPECT_THAT(both[1].text, HasSubstr("part[1]: 2 facets of \"back\""));
  EXPECT_THAT(both[1].text, HasSubstr("two_sided = true"));
  sweep.mutable_sweep()->mutable_part(1)->set_two_sided(true);
  EXPECT_EQ(warnings(kPlates).size(), 1U);
  sweep.mutable_sweep()->mutable_model()->set_accepted_backface_fraction(0.2);
  EXPECT_EQ(warnings(kPlates).size(), 0U) << "whoever states a share knows";
}

// 8 mm of steel, with the number of millimetres where metres are asked for.
TEST(JobRunner, WarnsOfLayersOfMetresOfMetal) {
  schema::ResolvedSweep sweep = plates();
  sweep.mutable_sweep()->mutable_model()->set_accepted_backface_fraction(0.2);
  schema::Layer& layer = *sweep.mutable_sweep()->add_build_up()->add_layer();
  const auto warnings = [&](double thickness_m, double conductivity_w_m_k, double density_kg_m3) {
    layer.set_thickness_m(thickness_m);
    layer.set_conductivity_w_m_k(conductivity_w_m_k);
    layer.set_density_kg_m3(density_kg_m3);
    return JobRunner::create(sweep, model_alone(sweep, kPlates), {}).value()->warnings();
  };
  const std::vector<Problem> steel = warnings(8, 50, 7800);
  ASSERT_EQ(steel.size(), 1U);
  EXPECT_EQ(steel[0].key, "build_up[0].layer[0].thickness_m");
  EXPECT_THAT(steel[0].text, HasSubstr("a layer of metal of 8 m: is it in millimetres? 8 mm are"));
  EXPECT_EQ(warnings(0.3, 50, 7800).size(), 0U);
  EXPECT_EQ(warnings(2, 1.6, 2300).size(), 0U);  // concrete
  EXPECT_EQ(warnings(50, 1.6, 2300).size(), 1U);
}

// An error above the relative one and not above the floor is a reason of its own to stop.
TEST(JobRunner, SaysThatTheFloorWasReached) {
  schema::ResolvedSweep sweep = soot(1e-6);
  schema::Accuracy& accuracy = *sweep.mutable_sweep()->mutable_accuracy();
  for (const double floor_k : {0.5, 5.0}) {
    accuracy.set_absolute_error_k(floor_k);
    const auto result = first_job(sweep, {});
    ASSERT_TRUE(result.ok()) << result.status();
    const schema::SignatureRow& row = result->view().row(0);
    EXPECT_EQ(row.stop_reason(), schema::STOP_REASON_FLOOR_REACHED);
    EXPECT_GT(row.numerical_error_w_sr(), 1e-6 * row.intensity_w_sr().value());
    EXPECT_LE(row.numerical_error_w_sr(), row.absolute_floor_w_sr());
  }
  // A row that reaches the relative error does not stop at the floor.
  accuracy.set_relative_error(0.05);
  const auto result = first_job(sweep, {});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->view().row(0).stop_reason(), schema::STOP_REASON_ACCURACY_REACHED);
}

// A hull in the sun has warm facets in every part: its mean decides whether it has rays of its own.
TEST(SweepTemperatures, APartIsHotByTheMeanOfItsFacets) {
  schema::ResolvedSweep sweep;
  schema::Condition& condition = *sweep.add_condition();
  condition.add_part_temperature_k(300);  // stated
  condition.add_part_temperature_k(0);    // of its facets
  SweepTemperatures temperatures;
  temperatures.condition = {std::make_shared<const EmitterTemperatures>()};
  temperatures.part_k = {{0, 600}};
  temperatures.part_mean_k = {{0, 320}};
  EXPECT_FALSE(is_hot(sweep, temperatures, 0));
  EXPECT_FALSE(is_hot(sweep, temperatures, 1));
  temperatures.part_mean_k = {{0, 330}};
  EXPECT_TRUE(is_hot(sweep, temperatures, 1));
  temperatures.part_mean_k = {{0, 260}};
  EXPECT_TRUE(is_hot(sweep, temperatures, 0)) << "the stated one, beside cold facets";
  EXPECT_FALSE(is_hot(sweep, temperatures, 1));
}

}  // namespace
}  // namespace irsig
