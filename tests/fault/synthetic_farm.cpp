#include "tests/fault/synthetic_farm.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <new>
#include <random>
#include <sstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "core/accuracy/image_layers.h"
#include "core/geo/sun.h"
#include "jobs/resolve_sweep.h"
#include "jobs/text/sweep_file.h"
#include "tests/fault/synthetic_ledger.h"
#include "tests/fault/synthetic_pictures.h"

namespace irsig {
namespace {

// The numbers of a row that have to fit each other: causes and parts sum to the intensity, shares
// of energy to their balance, shares are at most 1.
void make_plausible(schema::SignatureRow& row) {
  const double intensity_w_sr = row.emitted_w_sr().value() + row.sun_reflected_w_sr().value() +
                                row.sky_reflected_w_sr().value() +
                                row.surface_reflected_w_sr().value() +
                                row.interreflected_w_sr().value();
  row.mutable_intensity_w_sr()->set_value(intensity_w_sr);
  for (schema::PartIntensity& part : *row.mutable_part())
    part.mutable_intensity_w_sr()->set_value(intensity_w_sr / row.part_size());
  schema::EnergyLedger& energy = *row.mutable_energy();
  energy.mutable_balance()->set_value(
      energy.absorbed().value() / 100 + energy.escaped_to_sky().value() / 100 +
      energy.escaped_to_surface().value() / 100 + energy.cut_off().value() / 100);
  for (schema::Estimate* share : {energy.mutable_absorbed(), energy.mutable_escaped_to_sky(),
                                  energy.mutable_escaped_to_surface(), energy.mutable_cut_off()})
    share->set_value(share->value() / 100);
  for (schema::Estimate* share :
       {energy.mutable_absorbed(), energy.mutable_escaped_to_sky(),
        energy.mutable_escaped_to_surface(), energy.mutable_cut_off(), energy.mutable_balance()})
    share->set_stderr(1e-3);
  schema::Spectrum& s = *row.mutable_spectrum();
  for (int i = 0; i < s.lambda_um_size(); ++i) {
    s.set_path_transmittance(i, s.path_transmittance(i) / 100);
    s.set_spectral_intensity_w_sr_um(
        i, s.emitted_w_sr_um(i) + s.sun_reflected_w_sr_um(i) + s.sky_reflected_w_sr_um(i) +
               s.surface_reflected_w_sr_um(i) + s.interreflected_w_sr_um(i));
  }
}

class SyntheticRunner final : public JobRunner {
 public:
  SyntheticRunner(schema::ResolvedSweep sweep, HeatOutputs heat, const SyntheticWork& work)
      : sweep_(std::move(sweep)), heat_(std::move(heat)), work_(work) {}

  absl::StatusOr<schema::JobResult> run(const schema::JobSpec& job) const override {
    if (work_.seconds > 0)
      std::this_thread::sleep_for(std::chrono::duration<double>(work_.seconds));
    if (job.has_heat()) {
      if (work_.failing_heat.contains(job.heat().heat()))
        return absl::InternalError(absl::StrCat("heat run ", job.heat().heat(), " is cursed"));
      return synthetic_result(sweep_, job);
    }
    HeatOutputs expected;
    for (const std::string& needed : job.needs()) {
      schema::JobSpec heat_job;
      heat_job.set_job_key(needed);
      heat_job.mutable_heat()->set_heat(static_cast<std::uint32_t>(expected.size()));
      expected.push_back(synthetic_result(sweep_, heat_job).heat().field());
    }
    if (heat_ != expected)
      return absl::InternalError("a view without the temperatures that it needs");
    if (work_.crashing.contains(job.view().viewpoint_index())) std::abort();
    if (work_.failing.contains(job.view().viewpoint_index())) {
      return absl::InternalError(
          absl::StrCat("viewpoint ", job.view().viewpoint_index(), " is cursed"));
    }
    if (work_.needed_bytes > work_.memory_bytes) throw std::bad_alloc();
    auto result = synthetic_result(sweep_, job);
    if (work_.wrong.contains(job.view().viewpoint_index()))
      result.mutable_view()->mutable_row(0)->set_sun_azimuth_deg(
          std::nextafter(result.view().row(0).sun_azimuth_deg(), 400.0));
    return result;
  }

 private:
  schema::ResolvedSweep sweep_;
  HeatOutputs heat_;
  SyntheticWork work_;
};

void append(std::string& bytes, float value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// The first part has 4999 facets, another one the last.
schema::HeatJobResult synthetic_heat(const schema::HeatRun& run,
                                     const std::function<double()>& number) {
  constexpr std::uint32_t kFacets = 5000;
  schema::HeatJobResult out;
  schema::HeatField field;
  field.set_facets(kFacets);
  for (const std::string& time_utc : run.time_utc()) {
    double sum = 0, coldest = 1e9, hottest = 0;
    for (std::uint32_t f = 0; f + 1 < kFacets; ++f) {
      const auto kelvin = static_cast<float>(280 + number() / 1e3);
      append(*field.mutable_kelvin(), kelvin);
      append(*field.mutable_error_k(), 0.5F);
      sum += static_cast<double>(kelvin);
      coldest = std::min(coldest, static_cast<double>(kelvin));
      hottest = std::max(hottest, static_cast<double>(kelvin));
    }
    append(*field.mutable_kelvin(), NAN);
    append(*field.mutable_error_k(), NAN);
    schema::PartTemperature& part = *out.add_part();
    part.set_time_index(static_cast<std::uint32_t>(field.unix_s_size()));
    part.set_mean_k(sum / (kFacets - 1));
    part.set_coldest_k(coldest);
    part.set_hottest_k(hottest);
    part.set_error_k(0.5);
    field.add_unix_s(unix_seconds(*parse_rfc3339(time_utc)));
  }
  out.set_field(field.SerializeAsString());
  return out;
}

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

schema::ResolvedSweep heated_frigate_sweep(std::uint32_t viewpoints, const std::string& name) {
  schema::ResolvedSweep sweep = frigate_sweep(viewpoints, name);
  for (schema::Condition& condition : *sweep.mutable_condition()) {
    if (sweep.heat().empty() || sweep.heat().rbegin()->season() != condition.season())
      sweep.add_heat()->set_season(condition.season());
    condition.set_part_temperature_k(0, 0);
    schema::HeatRun& run = *sweep.mutable_heat()->rbegin();
    run.add_time_utc(condition.time_utc());
    *run.mutable_part_temperature_k() = condition.part_temperature_k();
    *run.mutable_surroundings() = condition.surroundings();
    *run.mutable_weather() = condition.weather();
    if (run.course().record().empty()) {
      schema::WeatherRecord& record = *run.mutable_course()->add_record();
      record.set_air_temperature_k(290);
      record.set_dew_point_k(280);
      record.set_pressure_pa(1e5);
    }
    schema::ConditionField& from = *condition.mutable_temperature_field();
    from.set_heat(static_cast<std::uint32_t>(sweep.heat_size() - 1));
    from.add_part(0);
  }
  return sweep;
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
  if (job.has_heat())
    *result.mutable_heat() =
        synthetic_heat(sweep.heat(static_cast<int>(job.heat().heat())), number);
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
      row->set_source_radiance_temperature_k(300 + number());
      estimate(row->mutable_emitted_w_sr());
      estimate(row->mutable_sun_reflected_w_sr());
      estimate(row->mutable_sky_reflected_w_sr());
      estimate(row->mutable_surface_reflected_w_sr());
      estimate(row->mutable_interreflected_w_sr());
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
          if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_FLOAT ||
              field->name().find("plume") != std::string::npos)
            continue;  // hot gas is of rows that say so
          spectrum->GetReflection()->AddFloat(spectrum, field, static_cast<float>(number()));
        }
      }
      auto* thumbnail = row->mutable_thumbnail();
      thumbnail->set_width_px(128);
      thumbnail->set_height_px(40);
      thumbnail->set_pixel_rad(1e-4);
      thumbnail->set_png(synthetic_png(128, 40, random));
      thumbnail->set_exr(synthetic_exr(128, 40, 20480, random));
      thumbnail->set_stderr_exr(synthetic_exr(128, 40, 4096, random));
      for (const std::string& name : sweep.sweep().image().layers()) {
        schema::ImageLayer& layer = *row->add_image_layer();
        layer.set_name(name);
        layer.set_exr(synthetic_exr(128, 40, 20480, random));
        if (has_standard_error(*image_layer_of(name)))
          layer.set_stderr_exr(synthetic_exr(128, 40, 4096, random));
      }
      row->set_stop_reason(schema::STOP_REASON_ACCURACY_REACHED);
      row->set_sun_azimuth_deg(150);
      row->set_sun_zenith_deg(50);
      make_plausible(*row);
    }
  }
  if (result.view().row_size() > 0)
    add_synthetic_silhouette(128, 40, sweep.sweep().part_size(), random, *result.mutable_view());
  result.set_samples(32 * 4096);
  result.set_replicates(32);
  result.set_target_paths(100000);
  result.set_rays(300000);
  result.set_seconds(0.1);
  result.set_seed_hex(job.has_heat()
                          ? absl::StrCat(absl::Hex(sweep.sweep().seed(), absl::kZeroPad16))
                          : "0123456789abcdef");
  result.set_physics_version(1);
  result.set_determinism_class(kSyntheticClass);
  result.set_build_id("test");
  return result;
}

RunnerFactory synthetic_runner(const SyntheticWork& work) {
  return [work](const schema::ResolvedSweep& sweep, const Assets& /*assets*/,
                const HeatOutputs& heat) -> absl::StatusOr<std::unique_ptr<JobRunner>> {
    return std::make_unique<SyntheticRunner>(sweep, heat, work);
  };
}

}  // namespace irsig
