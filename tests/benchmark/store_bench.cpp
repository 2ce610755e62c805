// Measures how many jobs a second complete() and its commits sustain, and how fast a nearest query
// is.
//
//   store_bench [folder = .] [jobs = 3000] [results in one commit = 64] [keep: leave the database]
//
// Each job: 6 rows (3 seasons x 2 bands of 41 and 81 wavelengths x 14 arrays, 8 parts, a 4 kB PNG
// and a 20 kB EXR of bytes that do not compress), synchronous = FULL, in the given folder: choose
// one on the disk in question.

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>

#include "schema/store/reader.h"
#include "schema/store/writer.h"
#include "tests/fault/synthetic_ledger.h"

namespace irsig {
namespace {

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

void check(const absl::Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "%s\n", status.ToString().c_str());
  std::exit(1);
}

schema::ResolvedSweep make_sweep(int viewpoints) {
  schema::ResolvedSweep resolved;
  schema::Sweep& sweep = *resolved.mutable_sweep();
  sweep.set_name("bench");
  for (int i = 0; i < 8; ++i) sweep.add_part()->set_name("part" + std::to_string(i));
  for (const auto& [name, min_um, max_um] :
       {std::tuple{"mwir", 3.0, 5.0}, std::tuple{"lwir", 8.0, 12.0}}) {
    schema::Band& band = *sweep.add_band();
    band.set_name(name);
    band.set_lambda_min_um(min_um);
    band.set_lambda_max_um(max_um);
  }
  for (int i = 0; i < viewpoints; ++i) {
    schema::Viewpoint& viewpoint = *resolved.add_viewpoint();
    viewpoint.set_aspect_azimuth_deg(std::fmod(137.50776405 * i, 360));
    viewpoint.set_aspect_elevation_deg(std::asin((i + 0.5) / viewpoints) * 57.29577951308232);
    viewpoint.set_range_m(5000);
  }
  for (const char* season : {"winter", "spring", "summer"}) {
    schema::Condition& condition = *resolved.add_condition();
    condition.set_season(season);
    condition.set_time_utc("2025-06-21T01:30:00Z");
    for (int i = 0; i < 8; ++i) condition.add_part_temperature_k(300);
  }
  return resolved;
}

std::vector<schema::JobSpec> make_jobs(int viewpoints) {
  std::vector<schema::JobSpec> jobs;
  for (int v = 0; v < viewpoints; ++v) {
    schema::JobSpec& job = jobs.emplace_back();
    job.set_job_key("job" + std::to_string(v));
    job.mutable_view()->set_viewpoint_index(static_cast<std::uint32_t>(v));
    for (std::uint32_t c = 0; c < 3; ++c) job.mutable_view()->add_condition_index(c);
    for (std::uint32_t b = 0; b < 2; ++b) job.mutable_view()->add_band_index(b);
  }
  return jobs;
}

schema::JobResult make_result(std::mt19937_64& random) {
  std::uniform_real_distribution<double> value(0.5, 100);
  const auto bytes = [&](std::size_t size) {
    std::string out(size, '\0');
    for (char& byte : out) byte = static_cast<char>(random());
    return out;
  };
  schema::JobResult result;
  result.set_replicates(32);
  result.set_rays(10'000'000);
  for (std::uint32_t c = 0; c < 3; ++c) {
    for (std::uint32_t b = 0; b < 2; ++b) {
      schema::SignatureRow& row = *result.mutable_view()->add_row();
      row.set_condition_index(c);
      row.set_band_index(b);
      for (auto* estimate :
           {row.mutable_intensity_w_sr(), row.mutable_apparent_intensity_w_sr(),
            row.mutable_projected_area_m2(), row.mutable_emitted_w_sr(),
            row.mutable_sun_reflected_w_sr(), row.mutable_sky_reflected_w_sr(),
            row.mutable_surface_reflected_w_sr(), row.mutable_interreflected_w_sr(),
            row.mutable_contrast_intensity_w_sr(), row.mutable_background_radiance_w_m2_sr()}) {
        estimate->set_value(value(random));
        estimate->set_stderr(1e-3 * value(random));
      }
      row.set_numerical_error_w_sr(1e-3 * value(random));
      row.set_stop_reason(schema::STOP_REASON_ACCURACY_REACHED);
      add_synthetic_ledger(row, [&] { return value(random); });
      for (std::uint32_t p = 0; p < 8; ++p) {
        schema::PartIntensity& part = *row.add_part();
        part.set_part_index(p);
        part.mutable_intensity_w_sr()->set_value(value(random));
      }
      schema::Spectrum& spectrum = *row.mutable_spectrum();
      const int wavelengths = b == 0 ? 41 : 81;
      for (int i = 0; i < wavelengths; ++i) spectrum.add_lambda_um((b == 0 ? 3 : 8) + 0.05 * i);
      for (int f = 0; f < spectrum.GetDescriptor()->field_count(); ++f) {
        const auto* field = spectrum.GetDescriptor()->field(f);
        if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_FLOAT ||
            field->name().find("plume") != std::string::npos)
          continue;  // hot gas is of rows that say so
        for (int i = 0; i < wavelengths; ++i) {
          spectrum.GetReflection()->AddFloat(&spectrum, field, static_cast<float>(value(random)));
        }
      }
      schema::Thumbnail& thumbnail = *row.mutable_thumbnail();
      thumbnail.set_width_px(128);
      thumbnail.set_height_px(72);
      thumbnail.set_pixel_rad(1e-5);
      thumbnail.set_png(bytes(4000));
      thumbnail.set_exr(bytes(20000));
    }
  }
  return result;
}

void bench_complete(const std::string& path, int jobs, int group) {
  auto opened = StoreWriter::open(path);
  check(opened.status());
  StoreWriter& writer = **opened;
  const double submitted_s = seconds();
  check(writer.begin());
  check(writer.add_sweep(make_sweep(jobs), "bench", make_jobs(jobs), {}).status());
  check(writer.commit());
  std::printf("add_sweep: %.3f s for %d jobs\n", seconds() - submitted_s, jobs);

  std::mt19937_64 random(1);
  std::vector<schema::JobResult> results;
  for (int i = 0; i < 16; ++i) results.push_back(make_result(random));
  const double start_s = seconds();
  const double start_cpu_s = cpu_seconds();
  double commit_s = 0;
  for (int done = 0; done < jobs;) {
    check(writer.begin());
    for (int i = 0; i < group && done < jobs; ++i, ++done) {
      const auto job = writer.lease_next("worker", 0);
      check(job.status());
      schema::JobResult& result = results[static_cast<std::size_t>(done) % results.size()];
      result.set_job_key((*job)->spec.job_key());
      check(writer.complete((*job)->fencing_token, result, "host:1"));
    }
    const double before_s = seconds();
    check(writer.commit());
    commit_s += seconds() - before_s;
  }
  const double took_s = seconds() - start_s;
  std::printf(
      "lease + complete + commit: %.0f jobs/s (%.2f s, of which commits %.2f s; CPU %.2f s), %d in "
      "a commit\n",
      jobs / took_s, took_s, commit_s, cpu_seconds() - start_cpu_s, group);
  const double finish_s = seconds();
  check(writer.finish());
  std::printf("finish: %.2f s, %.0f MB\n", seconds() - finish_s,
              1e-6 * static_cast<double>(std::filesystem::file_size(path)));
}

void bench_find(const std::string& path) {
  auto reader = StoreReader::open(path);
  check(reader.status());
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> azimuth(0, 360);
  SignatureFilter filter;
  filter.season = "summer";
  filter.band = "lwir";
  filter.nearest = 4;
  constexpr int kQueries = 500;
  std::vector<double> took_ms;
  for (int i = 0; i < kQueries; ++i) {
    filter.direction = {azimuth(random), azimuth(random) / 4};
    const double start_s = seconds();
    check((*reader)->find(filter).status());
    took_ms.push_back(1e3 * (seconds() - start_s));
  }
  std::sort(took_ms.begin(), took_ms.end());
  std::printf("nearest 4: %.3f ms (median), %.3f ms (99 %%)\n", took_ms[kQueries / 2],
              took_ms[kQueries * 99 / 100]);
  double start_s = seconds();
  SignatureFilter one;
  one.season = "summer";
  one.band = "lwir";
  const auto all = (*reader)->find(one);
  check(all.status());
  std::printf("all of one season and band: %.3f s for %zu rows\n", seconds() - start_s,
              all->size());
  start_s = seconds();
  ValueFilter shown{"bench", "summer", "2025-06-21T01:30:00Z", "lwir", 5000};
  const auto values = (*reader)->values(shown);
  check(values.status());
  std::printf("one quantity of these: %.3f s for %zu rows\n", seconds() - start_s, values->size());
  start_s = seconds();
  check((*reader)->contents().status());
  std::printf("contents: %.3f s\n", seconds() - start_s);
  start_s = seconds();
  const auto digest = (*reader)->digest();
  check(digest.status());
  std::printf("digest: %.2f s\n", seconds() - start_s);
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  const int jobs = argc > 2 ? std::atoi(argv[2]) : 3000;
  const int group = argc > 3 ? std::atoi(argv[3]) : 64;
  const std::string path = (folder / "store_bench.sigdb").string();
  std::filesystem::remove(path);
  irsig::bench_complete(path, jobs, group);
  irsig::bench_find(path);
  if (argc <= 4) std::filesystem::remove(path);
}
