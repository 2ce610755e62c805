#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "serve/answer_parts.h"
#include "serve/command_line.h"
#include "serve/json_text.h"
#include "view/compare.h"
#include "view/polar_cut.h"

namespace irsig {
namespace {

// Of which quantity the numbers are.
void name_quantity(JsonObject& out, SignatureQuantity quantity) {
  const QuantityColumns& q = columns_of(quantity);
  out.text("quantity", q.name);
  out.text("title", q.title);
  out.text("unit", q.unit);
  out.flag("signed", q.is_signed());
}

// One member of all values, as an array.
template <typename Value, typename Member>
std::vector<double> picked(const std::vector<Value>& values, const Member& member) {
  std::vector<double> out;
  out.reserve(values.size());
  for (const Value& v : values) out.push_back(member(v));
  return out;
}

template <typename Value, typename Member>
std::vector<std::uint64_t> picked_rows(const std::vector<Value>& values, const Member& member) {
  std::vector<std::uint64_t> out;
  out.reserve(values.size());
  for (const Value& v : values) out.push_back(member(v));
  return out;
}

std::string points(const std::vector<PolarPoint>& point) {
  JsonObject out;
  out.numbers("azimuth_deg", picked(point, [](const PolarPoint& p) { return p.azimuth_deg; }));
  out.numbers("value", picked(point, [](const PolarPoint& p) { return p.value; }));
  out.numbers("error", picked(point, [](const PolarPoint& p) { return p.error; }));
  return out.finish();
}

std::string describe(const SweepContents& sweep) {
  JsonObject out;
  out.text("name", sweep.name);
  out.count("viewpoints", sweep.viewpoints);
  out.count("rows", sweep.rows);
  out.count("whole_rows", sweep.whole_rows);
  out.flag("thumbnails", sweep.thumbnails);
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

// {"database": [what `describe` says of each]}; a database that cannot be read has its error in
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
    if (status.ok()) status = describe_one(sources.database[i], **reader, out);
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

absl::StatusOr<std::vector<StoredValue>> values_of_selection(StoreReader& reader,
                                                             const Selection& selection,
                                                             SignatureQuantity quantity) {
  auto values = reader.values(value_filter(selection, quantity));
  if (!values.ok()) return values.status();
  if (values->empty()) {
    // Explains a name that there is not.
    const auto rows = run_query(reader, selection_query(selection, quantity));
    if (!rows.ok()) return rows.status();
    return absl::NotFoundError(
        fmt::format("nothing is stored (yet) of sweep {}, {}, {}, {}, from {:g} m", selection.sweep,
                    selection.season, selection.time, selection.band, selection.at_range_m));
  }
  if (absl::Status status = check_computed(*values, quantity); !status.ok()) return status;
  return values;
}

absl::StatusOr<PageReply> answer_contents(const PageSources& sources) {
  JsonObject all = each_database(
      sources, [](const std::string&, StoreReader& reader, JsonObject& out) -> absl::Status {
        const auto contents = reader.contents();
        if (!contents.ok()) return contents.status();
        std::vector<std::string> sweeps;
        for (const SweepContents& sweep : *contents) sweeps.push_back(describe(sweep));
        out.objects("sweep", sweeps);
        return absl::OkStatus();
      });
  std::vector<std::string> detectors;
  for (const PageDetector& d : sources.detector) detectors.push_back(d.name);
  all.texts("detector", detectors);
  all.flag("accuracy_page", !sources.accuracy_page.empty());
  return json_reply(all.finish());
}

absl::StatusOr<PageReply> answer_progress(const PageSources& sources) {
  JsonObject all = each_database(
      sources, [](const std::string& path, StoreReader& reader, JsonObject& out) -> absl::Status {
        const auto progress = reader.progress();
        if (!progress.ok()) return progress.status();
        std::error_code ignored;
        // The writer's lock lies beside the database as long as there is one.
        out.flag("writing", std::filesystem::exists(path + "-lock", ignored));
        std::vector<std::string> sweeps;
        for (const SweepProgress& sweep : *progress) sweeps.push_back(describe(sweep));
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

absl::StatusOr<PageReply> answer_map(const PageSources& sources, const Question& q) {
  const auto reader = open_database(sources, q.a.database);
  if (!reader.ok()) return reader.status();
  const auto values = values_of_selection(**reader, q.a, q.quantity);
  if (!values.ok()) return values.status();
  JsonObject out;
  name_quantity(out, q.quantity);
  out.text("command", selection_command(sources.database[q.a.database], q.a, q.quantity));
  out.counts("row", picked_rows(*values, [](const StoredValue& v) { return v.row; }));
  out.numbers("azimuth_deg",
              picked(*values, [](const StoredValue& v) { return v.aspect_azimuth_deg; }));
  out.numbers("elevation_deg",
              picked(*values, [](const StoredValue& v) { return v.aspect_elevation_deg; }));
  out.numbers("value", picked(*values, [](const StoredValue& v) { return v.value; }));
  out.numbers("error", picked(*values, [](const StoredValue& v) { return v.numerical_error; }));
  return json_reply(out.finish());
}

absl::StatusOr<PageReply> answer_cut(const PageSources& sources, const Question& q) {
  const auto reader = open_database(sources, q.a.database);
  if (!reader.ok()) return reader.status();
  const auto values = values_of_selection(**reader, q.a, q.quantity);
  if (!values.ok()) return values.status();
  const auto cut = polar_cut(*values, columns_of(q.quantity), q.elevation_deg);
  if (!cut.ok()) return cut.status();
  JsonObject out;
  name_quantity(out, q.quantity);
  out.text("command", cut_command(sources.database[q.a.database], q, cut->elevation_deg));
  out.number("elevation_deg", cut->elevation_deg);
  out.flag("interpolated", cut->interpolated);
  out.number("near_deg", kNearRingDeg);
  out.json("point", points(cut->point));
  out.json("mark", points(cut->mark));
  return json_reply(out.finish());
}

absl::StatusOr<PageReply> answer_compare(const PageSources& sources, const Question& q) {
  const auto compared = compare_selections(sources, q);
  if (!compared.ok()) return compared.status();
  JsonObject out;
  name_quantity(out, q.quantity);
  out.text("command", selection_command(sources.database[q.a.database], q.a, q.quantity) + "\n" +
                          selection_command(sources.database[q.b->database], *q.b, q.quantity));
  const std::vector<ComparedAspect>& v = compared->value;
  using C = ComparedAspect;
  out.counts("a_row", picked_rows(v, [](const C& c) { return c.a.row; }));
  out.counts("b_row", picked_rows(v, [](const C& c) { return c.b.row; }));
  out.numbers("azimuth_deg", picked(v, [](const C& c) { return c.aspect_azimuth_deg; }));
  out.numbers("elevation_deg", picked(v, [](const C& c) { return c.aspect_elevation_deg; }));
  out.numbers("a", picked(v, [](const C& c) { return c.a.value; }));
  out.numbers("a_error", picked(v, [](const C& c) { return c.a.numerical_error; }));
  out.numbers("b", picked(v, [](const C& c) { return c.b.value; }));
  out.numbers("b_error", picked(v, [](const C& c) { return c.b.numerical_error; }));
  out.numbers("difference", picked(v, [](const C& c) { return c.difference; }));
  out.numbers("difference_error", picked(v, [](const C& c) { return c.difference_error; }));
  out.numbers("sigmas", picked(v, [](const C& c) { return c.sigmas; }));
  out.count("only_in_a", compared->only_in_a);
  out.count("only_in_b", compared->only_in_b);
  return json_reply(out.finish());
}

absl::StatusOr<Comparison> compare_selections(const PageSources& sources, const Question& q) {
  std::vector<StoredValue> values[2];
  const Selection* selection[2] = {&q.a, &*q.b};
  for (int i = 0; i < 2; ++i) {
    const auto reader = open_database(sources, selection[i]->database);
    if (!reader.ok()) return reader.status();
    auto found = values_of_selection(**reader, *selection[i], q.quantity);
    if (!found.ok()) return found.status();
    values[i] = *std::move(found);
  }
  Comparison out = compare(values[0], values[1]);
  if (out.value.empty())
    return absl::NotFoundError("the two have no aspect in common: nothing to compare");
  return out;
}

}  // namespace irsig
