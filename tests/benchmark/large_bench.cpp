// A database of many rows, and how fast it answers.
//
//   large_bench make SWEEP OUT.sigdb VIEWPOINTS [K/N]
//   large_bench ask DB [queries = 2000]
//
// make: computes the views of a small sweep, and stores their rows again and again under
// VIEWPOINTS directions, through the store's own writer: rows are true ones, but not those of their
// viewpoints; of a shard (jobs/shard.h) those that the whole would have. ask: prints one CSV line
// for each kind of question. docs/evidence/performance.md quotes them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "jobs/keys/expand.h"
#include "jobs/shard.h"
#include "planning/load_sweep.h"
#include "runner/job_runner.h"
#include "schema/store/reader.h"
#include "schema/store/writer.h"

namespace irsig {
namespace {

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void check(const absl::Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "%s\n", std::string(status.message()).c_str());
  std::exit(1);
}

schema::JobSpec job_of(const schema::ResolvedSweep& sweep, int viewpoint) {
  schema::JobSpec job;
  job.set_job_key("view " + std::to_string(viewpoint));
  job.mutable_view()->set_viewpoint_index(static_cast<std::uint32_t>(viewpoint));
  for (int i = 0; i < sweep.condition_size(); ++i)
    job.mutable_view()->add_condition_index(static_cast<std::uint32_t>(i));
  for (int i = 0; i < sweep.sweep().band_size(); ++i)
    job.mutable_view()->add_band_index(static_cast<std::uint32_t>(i));
  return job;
}

std::vector<schema::JobResult> computed(const LoadedSweep& loaded) {
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
  const auto runner = JobRunner::create(loaded.resolved, loaded.assets, loaded.heat, encoder);
  check(runner.status());
  std::vector<schema::JobResult> out;
  for (int v = 0; v < loaded.resolved.viewpoint_size(); ++v) {
    auto result = (*runner)->run(job_of(loaded.resolved, v));
    check(result.status());
    out.push_back(*std::move(result));
  }
  return out;
}

void make(const std::string& sweep_path, const std::string& path, int viewpoints,
          const std::string& shard) {
  auto loaded = load_sweep(sweep_path, {});
  check(loaded.status());
  std::vector<schema::JobResult> results = computed(*loaded);
  schema::ResolvedSweep sweep = loaded->resolved;
  const double range_m = sweep.viewpoint(0).range_m();
  sweep.clear_viewpoint();
  sweep.mutable_sweep()->mutable_transport()->set_job_size_vertices(1e18);  // a job is a view
  for (int i = 0; i < viewpoints; ++i) {
    schema::Viewpoint& viewpoint = *sweep.add_viewpoint();
    viewpoint.set_aspect_azimuth_deg(std::fmod(137.50776405 * i, 360));
    viewpoint.set_aspect_elevation_deg(std::asin((i + 0.5) / viewpoints) * 57.29577951308232);
    viewpoint.set_range_m(range_m);
  }
  check(take_shard(shard, sweep));
  const std::vector<schema::JobSpec> jobs = expand_jobs(sweep, physics_version());
  std::vector<Asset> assets;
  for (const auto& [sha256, bytes] : loaded->assets) assets.push_back({sha256, bytes});
  const auto writer = StoreWriter::open(path);
  check(writer.status());
  const double start_s = seconds();
  check((*writer)->begin());
  check((*writer)->add_sweep(sweep, jobs.front().sweep_sha256(), jobs, assets).status());
  check((*writer)->commit());
  const double added_s = seconds() - start_s;
  for (std::size_t done = 0; done < jobs.size();) {
    check((*writer)->begin());
    for (int i = 0; i < 16 && done < jobs.size(); ++i, ++done) {
      const auto job = (*writer)->lease_next("bench", 0);
      check(job.status());
      schema::JobResult& result = results[(*job)->spec.view().viewpoint_index() % results.size()];
      result.set_job_key((*job)->spec.job_key());
      check((*writer)->complete((*job)->fencing_token, result, "bench"));
    }
    check((*writer)->commit());
  }
  check((*writer)->finish());
  std::printf("%zu rows written in %.1f s, %.1f s of these submitting, %.3f GB\n",
              jobs.size() * static_cast<std::size_t>(sweep.condition_size()) *
                  static_cast<std::size_t>(sweep.sweep().band_size()),
              seconds() - start_s, added_s,
              1e-9 * static_cast<double>(std::filesystem::file_size(path)));
}

void ask(const std::string& path, int queries) {
  const double open_s = seconds();
  const auto reader = StoreReader::open(path);
  check(reader.status());
  const auto contents = (*reader)->contents();
  check(contents.status());
  const SweepContents& sweep = contents->front();
  std::printf("question,median_ms,p99_ms,rows\nopen and contents,%.1f,,%llu\n",
              1e3 * (seconds() - open_s), static_cast<unsigned long long>(sweep.rows));
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto any = [&](const auto& list) -> const auto& {
    return list[static_cast<std::size_t>(unit(random) * static_cast<double>(list.size()))];
  };
  const auto measure = [&](const char* what, int count,
                           const std::function<absl::StatusOr<std::size_t>()>& question) {
    std::vector<double> took_ms;
    std::size_t rows = 0;
    for (int i = 0; i < count; ++i) {
      const double start_s = seconds();
      const auto found = question();
      check(found.status());
      took_ms.push_back(1e3 * (seconds() - start_s));
      rows = *found;
    }
    std::sort(took_ms.begin(), took_ms.end());
    std::printf("%s,%.3f,%.3f,%zu\n", what, took_ms[took_ms.size() / 2],
                took_ms[took_ms.size() * 99 / 100], rows);
    std::fflush(stdout);
  };
  const auto condition = [&](SignatureFilter& filter) {
    const SweepContents::Condition& c = any(sweep.condition);
    filter.sweep = sweep.name;
    filter.season = c.season;
    filter.time_utc = c.time_utc;
    filter.band = any(sweep.band).name;
  };
  const auto direction = [&] {
    return SignatureFilter::Direction{360 * unit(random), 90 * unit(random)};
  };
  const auto find = [&](const SignatureFilter& filter) -> absl::StatusOr<std::size_t> {
    const auto found = (*reader)->find(filter);
    if (!found.ok()) return found.status();
    return found->size();
  };
  for (const std::uint32_t nearest : {1u, 4u})
    measure(nearest == 1 ? "nearest viewpoint of a condition and band"
                         : "nearest 4 viewpoints of a condition and band",
            queries, [&] {
              SignatureFilter filter;
              condition(filter);
              filter.direction = direction();
              filter.nearest = nearest;
              return find(filter);
            });
  measure("nearest viewpoint, all conditions and bands", queries / 10, [&] {
    SignatureFilter filter;
    filter.direction = direction();
    filter.nearest = 1;
    return find(filter);
  });
  measure("one row by its number", queries, [&] {
    SignatureFilter filter;
    filter.row = 1 + static_cast<std::uint64_t>(unit(random) * static_cast<double>(sweep.rows));
    return find(filter);
  });
  measure("one quantity of a condition and band", queries / 10,
          [&]() -> absl::StatusOr<std::size_t> {
            const SweepContents::Condition& c = any(sweep.condition);
            const auto values = (*reader)->values(
                {sweep.name, c.season, c.time_utc, any(sweep.band).name, sweep.range_m.front()});
            if (!values.ok()) return values.status();
            return values->size();
          });
  measure("all columns of a condition and band", std::max(1, queries / 100), [&] {
    SignatureFilter filter;
    condition(filter);
    return find(filter);
  });
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "make" && (argc == 5 || argc == 6)) {
    irsig::make(argv[2], argv[3], std::atoi(argv[4]), argc > 5 ? argv[5] : "1/1");
  } else if (what == "ask" && argc >= 3) {
    irsig::ask(argv[2], argc > 3 ? std::atoi(argv[3]) : 2000);
  } else {
    std::fprintf(stderr,
                 "usage: large_bench make SWEEP OUT.sigdb VIEWPOINTS [K/N] | ask DB [queries]\n");
    return 2;
  }
}
