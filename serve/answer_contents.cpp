#include <filesystem>

#include "core/base/status_macros.h"
#include "schema/store/whole_file.h"
#include "serve/answer_parts.h"
#include "serve/json_text.h"
#include "view/report/compare.h"

namespace irsig {
namespace {

// A sweep among those of the page.
struct PlacedSweep {
  std::size_t database;
  SweepContents contents;
  std::vector<AspectKey> aspect = {};  // of its first condition and band, sorted
};

bool share_an_aspect(const PlacedSweep& a, const PlacedSweep& b) {
  auto i = a.aspect.begin(), j = b.aspect.begin();
  while (i != a.aspect.end() && j != b.aspect.end()) {
    if (*i == *j) return true;
    ++(*i < *j ? i : j);
  }
  return false;
}

// Returns the aspects of a sweep. They are empty if no row is stored yet, or if the rows cannot be
// read, which the next request for them reports.
std::vector<AspectKey> aspects_of(StoreReader& reader, const SweepContents& sweep) {
  if (sweep.condition.empty() || sweep.band.empty() || sweep.range_m.empty()) return {};
  const auto& [season, time_utc] = sweep.condition.front();
  const auto values =
      reader.values({sweep.name, season, time_utc, sweep.band.front().name, sweep.range_m.front()});
  return values.ok() ? aspect_keys(*values) : std::vector<AspectKey>();
}

// Returns the sweeps of all readable databases. Aspects are read only if there are several sweeps
// that could share them.
std::vector<PlacedSweep> placed_sweeps(const PageSources& sources) {
  std::vector<PlacedSweep> out;
  for (std::size_t i = 0; i < sources.database.size(); ++i) {
    const auto reader = open_database(sources, i);
    if (!reader.ok()) continue;
    const auto contents = (*reader)->contents();
    if (!contents.ok()) continue;
    for (const SweepContents& sweep : *contents) out.push_back({i, sweep});
  }
  if (out.size() < 2) return out;
  for (PlacedSweep& sweep : out)
    if (const auto reader = open_database(sources, sweep.database); reader.ok())
      sweep.aspect = aspects_of(**reader, sweep.contents);
  return out;
}

std::vector<std::string> shared_with(const PlacedSweep& sweep,
                                     const std::vector<PlacedSweep>& all) {
  std::vector<std::string> out;
  for (const PlacedSweep& other : all) {
    if (&other != &sweep && !share_an_aspect(sweep, other)) continue;
    JsonObject place;
    place.count("db", other.database);
    place.text("sweep", other.contents.name);
    out.push_back(place.finish());
  }
  return out;
}

std::string describe(const SweepContents& sweep, const std::vector<std::string>& shared) {
  JsonObject out;
  out.text("name", sweep.name);
  out.count("viewpoints", sweep.viewpoints);
  out.count("rows", sweep.rows);
  out.count("whole_rows", sweep.whole_rows);
  out.flag("thumbnails", sweep.thumbnails);
  out.flag("clutter", sweep.clutter);
  std::vector<std::string> conditions, bands;
  for (const auto& c : sweep.condition) {
    JsonObject condition;
    condition.text("season", c.season);
    condition.text("time_utc", c.time_utc);
    conditions.push_back(condition.finish());
  }
  for (const auto& b : sweep.band) {
    JsonObject band;
    band.text("name", b.name);
    band.number("lambda_min_um", b.lambda_min_um);
    band.number("lambda_max_um", b.lambda_max_um);
    bands.push_back(band.finish());
  }
  out.objects("condition", conditions);
  out.objects("band", bands);
  out.numbers("range_m", sweep.range_m);
  out.objects("shares", shared);
  return out.finish();
}

std::string describe(const SweepProgress& sweep) {
  JsonObject out;
  out.text("name", sweep.name);
  out.count("jobs", sweep.jobs);
  out.count("waiting", sweep.waiting);
  out.count("leased", sweep.leased);
  out.count("done", sweep.done);
  out.count("failed", sweep.quarantined);
  out.count("cancelled", sweep.cancelled);
  out.count("heat_jobs", sweep.heat_jobs);
  out.count("heat_done", sweep.heat_done);
  out.number("worst_relative_error", sweep.worst_relative_error);
  out.texts("failures", sweep.failures);
  return out.finish();
}

// {"database": [what `describe_one` says of each]}; a database that cannot be read has its error in
// place of that.
template <typename Describe>
JsonObject each_database(const PageSources& sources, const Describe& describe_one) {
  std::vector<std::string> databases;
  for (std::size_t i = 0; i < sources.database.size(); ++i) {
    JsonObject out;
    out.text("path", sources.database[i]);
    out.text("name", std::filesystem::path(sources.database[i]).filename().string());
    auto reader = open_database(sources, i);
    absl::Status status = reader.status();
    if (status.ok()) status = describe_one(i, **reader, out);
    if (!status.ok()) out.text("error", std::string(status.message()));
    databases.push_back(out.finish());
  }
  JsonObject all;
  all.objects("database", databases);
  return all;
}

std::string describe(const PageFarm& farm) {
  JsonObject out;
  out.count("workers", farm.workers);
  std::vector<std::string> workers;
  for (const PageWorker& w : farm.worker) {
    JsonObject worker;
    worker.text("name", w.name);
    worker.text("state", w.state);
    if (w.job_s) worker.number("job_s", *w.job_s);
    worker.text("job_key", w.job_key);
    worker.text("determinism_class", w.determinism_class);
    worker.text("reason", w.reason);
    worker.count("memory_bytes", w.memory_bytes);
    workers.push_back(worker.finish());
  }
  out.objects("worker", workers);
  out.texts("warning", farm.warning);
  return out.finish();
}

}  // namespace

absl::StatusOr<PageReply> answer_contents(const PageSources& sources) {
  const std::vector<PlacedSweep> all = placed_sweeps(sources);
  JsonObject page = each_database(
      sources, [&](std::size_t database, StoreReader& reader, JsonObject& out) -> absl::Status {
        if (const auto contents = reader.contents(); !contents.ok()) return contents.status();
        std::vector<std::string> sweeps;
        for (const PlacedSweep& sweep : all)
          if (sweep.database == database)
            sweeps.push_back(describe(sweep.contents, shared_with(sweep, all)));
        out.objects("sweep", sweeps);
        return absl::OkStatus();
      });
  std::vector<std::string> detectors;
  for (const PageDetector& d : sources.detector) detectors.push_back(d.name);
  page.texts("detector", detectors);
  page.flag("accuracy_page", !sources.accuracy_page.empty());
  return json_reply(page.finish());
}

absl::StatusOr<PageReply> answer_progress(const PageSources& sources) {
  JsonObject all = each_database(
      sources, [&](std::size_t database, StoreReader& reader, JsonObject& out) -> absl::Status {
        ASSIGN_OR_RETURN(const auto progress, reader.progress());
        out.flag("writing", has_writer_lock(sources.database[database]));
        std::vector<std::string> sweeps;
        for (const SweepProgress& sweep : progress) sweeps.push_back(describe(sweep));
        out.objects("sweep", sweeps);
        return absl::OkStatus();
      });
  if (sources.farm) {
    const auto farm = sources.farm();
    if (farm.ok())
      all.json("farm", describe(*farm));
    else
      all.text("farm_error", std::string(farm.status().message()));
  }
  return json_reply(all.finish());
}

}  // namespace irsig
