// Measures the cost of one more condition in a view: every view of a sweep is computed twice in
// this process, and the first of all once more before.
//   hours_bench SWEEP [SWEEP ...]
// Prints one CSV line a sweep. Two sweeps that differ in their hours alone give the cost of an
// hour: differences of "a view" over those of the conditions. docs/evidence/performance.md quotes
// them.
#include <sys/resource.h>

#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "jobs/keys/expand.h"
#include "planning/load_sweep.h"
#include "runner/job_runner.h"

namespace irsig {
namespace {

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double most_resident_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;
}

int measure(const std::string& path) {
  auto loaded = load_sweep(path, {});
  if (loaded.ok()) {
    if (const auto known = have_temperatures(*loaded); !known.ok()) loaded = known;
  }
  if (!loaded.ok()) {
    std::fprintf(stderr, "%s\n", std::string(loaded.status().message()).c_str());
    return 2;
  }
  const ThumbnailEncoder encoder{
      [](std::uint32_t width_px, std::uint32_t height_px, const std::vector<float>& pixels) {
        return encode_png({width_px, height_px, pixels});
      },
      [](std::uint32_t width_px, std::uint32_t height_px, const std::vector<float>& pixels) {
        return encode_exr({width_px, height_px, pixels});
      },
      [](std::uint32_t width_px, std::uint32_t height_px, const std::vector<float>& pixels) {
        return encode_error_exr({width_px, height_px, pixels});
      }};
  const auto runner = JobRunner::create(loaded->resolved, loaded->assets, loaded->heat, encoder);
  if (!runner.ok()) {
    std::fprintf(stderr, "%s\n", std::string(runner.status().message()).c_str());
    return 2;
  }
  double first = 0, again = 0, views = 0;
  for (int round = 0; round < 2; ++round)
    for (int view = 0; view < loaded->resolved.viewpoint_size(); ++view) {
      schema::JobSpec job;
      job.set_job_key(std::string(64, '0'));
      job.mutable_view()->set_viewpoint_index(static_cast<std::uint32_t>(view));
      for (int i = 0; i < loaded->resolved.condition_size(); ++i)
        job.mutable_view()->add_condition_index(static_cast<std::uint32_t>(i));
      for (int i = 0; i < loaded->resolved.sweep().band_size(); ++i)
        job.mutable_view()->add_band_index(static_cast<std::uint32_t>(i));
      const double start = cpu_s();
      const auto result = (*runner)->run(job);
      if (!result.ok()) {
        std::fprintf(stderr, "%s\n", std::string(result.status().message()).c_str());
        return 1;
      }
      const double taken = cpu_s() - start;
      std::fprintf(stderr, "view %d: %.3f s, %.0f samples\n", view, taken,
                   static_cast<double>(result->samples()));
      if (round == 0 && view == 0) first = taken;
      if (round == 1) {
        again += taken;
        views += 1;
        if (view == 0) first -= taken;
      }
    }
  std::printf("%s,%d,%.0f,%.1f,%.1f,%.0f\n", path.c_str(), loaded->resolved.condition_size(), views,
              1e3 * again / views, 1e3 * first, most_resident_mb());
  return 0;
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  std::printf("sweep,conditions,views,view_ms,shared_ms,most_resident_mb\n");
  for (int i = 1; i < argc; ++i)
    if (const int failed = irsig::measure(argv[i])) return failed;
  return argc > 1 ? 0 : 2;
}
