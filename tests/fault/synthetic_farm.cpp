#include "tests/fault/synthetic_farm.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "jobs/sweep_file.h"
#include "tests/fault/synthetic_ledger.h"

namespace irsig {
namespace {

std::string random_bytes(std::mt19937_64& random, std::size_t size) {
  std::string bytes(size, '\0');
  for (char& c : bytes) c = static_cast<char>(random());
  return bytes;
}

class SyntheticRunner final : public JobRunner {
 public:
  SyntheticRunner(schema::ResolvedSweep sweep, const SyntheticWork& work)
      : sweep_(std::move(sweep)), work_(work) {}

  absl::StatusOr<schema::JobResult> run(const schema::JobSpec& job) override {
    if (work_.seconds > 0)
      std::this_thread::sleep_for(std::chrono::duration<double>(work_.seconds));
    if (work_.crashing.contains(job.view().viewpoint_index())) std::abort();
    if (work_.failing.contains(job.view().viewpoint_index())) {
      return absl::InternalError(
          absl::StrCat("viewpoint ", job.view().viewpoint_index(), " is cursed"));
    }
    return synthetic_result(sweep_, job);
  }

 private:
  schema::ResolvedSweep sweep_;
  SyntheticWork work_;
};

}  // namespace

schema::ResolvedSweep frigate_sweep(std::uint32_t viewpoints, const std::string& name) {
  const std::string path = IRSIG_SOURCE_DIR "/jobs/examples/frigate.toml";
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  auto file = parse_sweep(text.str(), path);
  if (file.ok()) {
    file->sweep.set_name(name);
    file->sweep.mutable_viewpoints()->set_count(viewpoints);
    auto resolved = resolve_sweep(*file, "");
    if (resolved.ok()) return *std::move(resolved);
    file = resolved.status();
  }
  std::fprintf(stderr, "%s\n", file.status().ToString().c_str());
  std::abort();
}

schema::JobResult synthetic_result(const schema::ResolvedSweep& sweep, const schema::JobSpec& job) {
  std::mt19937_64 random(std::strtoull(job.job_key().substr(0, 16).c_str(), nullptr, 16));
  const auto number = [&random] { return 1.0 + static_cast<double>(random() >> 40) / 1e6; };
  const auto estimate = [&](schema::Estimate* out) {
    out->set_value(number());
    out->set_stderr(1e-3);
  };
  schema::JobResult result;
  result.set_job_key(job.job_key());
  for (const std::uint32_t condition : job.view().condition_index()) {
    for (const std::uint32_t band_index : job.view().band_index()) {
      const schema::Band& band = sweep.sweep().band(static_cast<int>(band_index));
      auto* row = result.mutable_view()->add_row();
      row->set_condition_index(condition);
      row->set_band_index(band_index);
      estimate(row->mutable_intensity_w_sr());
      row->set_numerical_error_w_sr(2e-3);
      row->set_truncation_bound_w_sr(1e-3);
      row->set_quadrature_bound_w_sr(1e-4);
      estimate(row->mutable_apparent_intensity_w_sr());
      row->set_apparent_numerical_error_w_sr(2e-3);
      estimate(row->mutable_contrast_intensity_w_sr());
      row->set_contrast_numerical_error_w_sr(2e-3);
      estimate(row->mutable_background_radiance_w_m2_sr());
      row->set_path_transmittance(0.5);
      add_synthetic_ledger(*row, number);
      estimate(row->mutable_projected_area_m2());
      row->set_apparent_temperature_k(300 + number());
      estimate(row->mutable_emitted_w_sr());
      estimate(row->mutable_sun_reflected_w_sr());
      estimate(row->mutable_sky_reflected_w_sr());
      estimate(row->mutable_sea_reflected_w_sr());
      estimate(row->mutable_parts_reflected_w_sr());
      for (int part = 0; part < sweep.sweep().part_size(); ++part) {
        auto* out = row->add_part();
        out->set_part_index(static_cast<std::uint32_t>(part));
        estimate(out->mutable_intensity_w_sr());
      }
      auto* spectrum = row->mutable_spectrum();
      const auto steps = static_cast<int>(
          std::lround((band.lambda_max_um() - band.lambda_min_um()) / band.step_um()));
      for (int i = 0; i <= steps; ++i) {
        spectrum->add_lambda_um(band.lambda_min_um() + i * band.step_um());
        for (int f = 0; f < spectrum->GetDescriptor()->field_count(); ++f) {
          const auto* field = spectrum->GetDescriptor()->field(f);
          if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_FLOAT) continue;
          spectrum->GetReflection()->AddFloat(spectrum, field, static_cast<float>(number()));
        }
      }
      auto* thumbnail = row->mutable_thumbnail();
      thumbnail->set_width_px(128);
      thumbnail->set_height_px(40);
      thumbnail->set_pixel_rad(1e-4);
      thumbnail->set_png(random_bytes(random, 4096));
      thumbnail->set_exr(random_bytes(random, 20480));
      row->set_stop_reason(schema::STOP_REASON_TARGET_REACHED);
      row->set_sun_azimuth_deg(150);
      row->set_sun_zenith_deg(50);
    }
  }
  result.set_samples(32 * 4096);
  result.set_replicates(32);
  result.set_target_paths(100000);
  result.set_rays(300000);
  result.set_seconds(0.1);
  result.set_seed_hex("0123456789abcdef");
  result.set_physics_version(1);
  result.set_determinism_class(kSyntheticClass);
  result.set_build_id("test");
  return result;
}

RunnerFactory synthetic_runner(const SyntheticWork& work) {
  return [work](const schema::ResolvedSweep& sweep, const Assets& /*assets*/,
                const HeatOutputs& heat) -> absl::StatusOr<std::unique_ptr<JobRunner>> {
    return std::make_unique<SyntheticRunner>(sweep, work);
  };
}

}  // namespace irsig
