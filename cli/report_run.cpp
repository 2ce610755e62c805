#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/commands.h"
#include "cli/output_options.h"
#include "coordinator/client/progress_text.h"
#include "core/accuracy/cost_model.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "fmt/ostream.h"
#include "planning/amount_text.h"
#include "planning/prediction.h"
#include "schema/shard.h"
#include "view/base/print.h"
#include "view/base/table.h"
#include "view/report/outcome.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

// One line of the comparison; the ratio is predicted / real.
void print_line(std::ostream& out, const char* what, const std::optional<double>& predicted,
                double real, std::string (*text)(double)) {
  if (!predicted) {
    fmt::print(out, "  {:<24} {:>12} {:>12}\n", what, "-", text(real));
    return;
  }
  fmt::print(out, "  {:<24} {:>12} {:>12} {:>7.2f}\n", what, text(*predicted), text(real),
             real > 0 ? *predicted / real : NAN);
}

std::string whole(double count) { return fmt::format("{:.0f}", count); }

// Sums over the done jobs of a sweep.
struct JobSums {
  std::vector<double> cpu_s;  // [job]
  double total_s = 0, wall_s = NAN, rays = 0;
  std::uint64_t backface = 0, nonfinite = 0, negative = 0, path_limit = 0;  // guarded events
  std::uint64_t uncounted = 0;  // jobs that did not count negative weights
};

JobSums sums_of(const std::vector<StoredJobCost>& jobs) {
  JobSums sums;
  double first_s = INFINITY, last_s = 0;
  for (const StoredJobCost& job : jobs) {
    sums.cpu_s.push_back(job.cpu_s);
    sums.total_s += job.cpu_s;
    sums.rays += static_cast<double>(job.rays);
    first_s = std::min(first_s, job.leased_unix_s);
    last_s = std::max(last_s, job.leased_unix_s + job.cpu_s);
    sums.backface += job.guarded_backface_hits;
    sums.nonfinite += job.guarded_nonfinite;
    sums.path_limit += job.truncated_paths;
    sums.negative += job.guarded_negative.value_or(0);
    sums.uncounted += job.guarded_negative ? 0 : 1;
  }
  if (!jobs.empty()) sums.wall_s = last_s - first_s;
  return sums;
}

void print_cost(std::ostream& out, const JobSums& sums, const std::optional<StoredPrediction>& p,
                double bytes, std::size_t sweeps) {
  const auto of = [&](auto member) {
    return p ? std::optional<double>(static_cast<double>((*p).*member)) : std::nullopt;
  };
  fmt::print(out, "  {:<24} {:>12} {:>12} {:>7}\n", "", p ? "predicted" : "no prediction", "real",
             p ? "ratio" : "");
  print_line(out, "jobs", of(&StoredPrediction::jobs), static_cast<double>(sums.cpu_s.size()),
             whole);
  print_line(out, "median job, CPU time", of(&StoredPrediction::job_cpu_median_s),
             quantile(sums.cpu_s, 0.5), seconds_text);
  print_line(out, "  first quartile", of(&StoredPrediction::job_cpu_quartile1_s),
             quantile(sums.cpu_s, 0.25), seconds_text);
  print_line(out, "  third quartile", of(&StoredPrediction::job_cpu_quartile3_s),
             quantile(sums.cpu_s, 0.75), seconds_text);
  print_line(out, "CPU time of all jobs", of(&StoredPrediction::cpu_s), sums.total_s, seconds_text);
  print_line(out, "wall time", of(&StoredPrediction::wall_s), sums.wall_s, seconds_text);
  print_line(out, sweeps > 1 ? "database (all sweeps)" : "database",
             of(&StoredPrediction::database_bytes), bytes, bytes_text);
  fmt::print(
      out,
      "  wall time: from the first lease to the end of the last job, pauses of an interrupted run "
      "included{}\n",
      p ? fmt::format("; predicted for {} worker{}, their start included", p->workers,
                      p->workers == 1 ? "" : "s")
        : "");
}

// A part of the squared numerical error of the source intensity. The parts (sampling, undersampling
// and each bound) sum to 1.
struct ErrorShare {
  std::string what;
  double mean = 0, largest = 0;
};

// The errors of a sweep's rows.
class RowErrors {
 public:
  RowErrors() {
    share_ = {{"sampling"}, {"undersampling, estimate"}};
    for (std::size_t i = 0; i < kBounds; ++i)
      share_.push_back({std::string(info_of(static_cast<BoundOf>(i)).name)});
  }

  // row: of StoreReader::visit_errors
  void add(const StoredSignature& row) {
    if (row.superseded) {
      ++superseded_;
      return;
    }
    ++rows_;
    ++reason_[row.stop_reason];
    if (row.intensity_w_sr != 0)
      relative_.push_back(row.numerical_error_w_sr / std::abs(row.intensity_w_sr));
    const Measured source = source_of(row);
    if (!(source.numerical_error() > 0)) return;
    ++counted_;
    old_ = old_ || std::isnan(row.spectral_basis_bound_w_sr);
    const auto add_to = [&](ErrorShare& share, double part) {
      share.mean += part;
      share.largest = std::max(share.largest, part);
    };
    add_to(share_[0], source.sampled_fraction());
    add_to(share_[1], source.unseen_fraction());
    for (std::size_t i = 0; i < kBounds; ++i)
      add_to(share_[i + 2], source.share(static_cast<BoundOf>(i)));
  }

  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  [[nodiscard]] std::uint64_t superseded() const { return superseded_; }
  // Returns how many rows each reason stopped.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& reasons() const { return reason_; }
  // Numerical errors over intensities, of rows whose intensity is not 0.
  [[nodiscard]] const std::vector<double>& relative() const { return relative_; }
  // Returns true if bounds of some rows are not kept apart, which an older format did not do.
  [[nodiscard]] bool has_old_rows() const { return old_; }

  // Empty: no row has an error.
  [[nodiscard]] std::vector<ErrorShare> shares() const {
    std::vector<ErrorShare> out;
    // At the target itself neither depth nor another range counts, and few rows have hot gas.
    for (const ErrorShare& share : share_)
      if (share.largest > 0)
        out.push_back({share.what, share.mean / static_cast<double>(counted_), share.largest});
    return out;
  }

 private:
  std::uint64_t rows_ = 0, superseded_ = 0, counted_ = 0;
  bool old_ = false;
  std::map<std::string, std::uint64_t> reason_;
  std::vector<double> relative_;
  std::vector<ErrorShare> share_;  // sums in the place of means
};

void print_errors(std::ostream& out, const RowErrors& rows, const schema::Accuracy& accuracy) {
  if (accuracy.has_relative_error())
    fmt::print(out, "\nrelative error asked: {:g} %\n", 100 * accuracy.relative_error());
  else
    fmt::print(out, "\nno relative error was asked for: the number of samples was given\n");
  const std::vector<double>& errors = rows.relative();
  if (!errors.empty())
    fmt::print(
        out,
        "numerical error / intensity: median {:.3g} %, 10 % of rows below {:.3g} %, 10 % above "
        "{:.3g} %, 1 % above {:.3g} %, largest {:.3g} %\n",
        100 * quantile(errors, 0.5), 100 * quantile(errors, 0.1), 100 * quantile(errors, 0.9),
        100 * quantile(errors, 0.99), 100 * quantile(errors, 1));
  if (rows.rows() > errors.size())
    fmt::print(out, "rows of intensity 0: {}\n", rows.rows() - errors.size());
  fmt::print(out, "stopped by:");
  for (const auto& [reason, count] : rows.reasons()) fmt::print(out, " {} {}", reason, count);
  fmt::print(out, "\n");
  if (rows.reasons().contains("floor_reached"))
    fmt::print(out, "floor_reached: not the relative error, but the floor of {:g} K\n",
               accuracy.absolute_error_k());
}

void print_shares(std::ostream& out, const RowErrors& rows) {
  const std::vector<ErrorShare> shares = rows.shares();
  if (shares.empty()) return;
  fmt::print(out, "share of the numerical error's square, mean over the rows (largest):\n ");
  for (const ErrorShare& share : shares)
    fmt::print(out, " {} {:.3g} % ({:.3g} %)", share.what, 100 * share.mean, 100 * share.largest);
  fmt::print(out, "\n");
  if (rows.has_old_rows())
    fmt::print(out, "  some rows are of an older format, which did not keep every bound apart\n");
}

void print_guards(std::ostream& out, const JobSums& sums) {
  fmt::print(out, "guarded events: back faces {}, not finite {}, negative {}{}\n", sums.backface,
             sums.nonfinite, sums.negative,
             sums.uncounted > 0 ? fmt::format(" ({} jobs did not count)", sums.uncounted) : "");
  fmt::print(out, "paths alive after the last reflection: {}\n", sums.path_limit);
}

// All that the report on a sweep is made of.
struct SweepReport {
  SweepProgress progress;
  StoredSweep sweep;
  std::vector<StoredJobCost> jobs;  // its views
  JobSums sums;                     // of them
  std::vector<StoredHeatJob> heat;  // its jobs that compute temperatures
  std::optional<StoredPrediction> prediction;
  RowErrors rows;
  LimitNotes limits;
  std::map<std::string, std::uint64_t> warnings;  // how many conditions have it
  std::string back_faces, images;
};

absl::StatusOr<SweepReport> gather(StoreReader& reader, const SweepProgress& progress) {
  SweepReport report;
  report.progress = progress;
  ASSIGN_OR_RETURN(auto sweep, reader.sweep(progress.name, SweepFiles::kNone));
  report.sweep = std::move(sweep);
  ASSIGN_OR_RETURN(auto jobs, reader.job_costs(progress.name));
  report.jobs = std::move(jobs);
  report.sums = sums_of(report.jobs);
  ASSIGN_OR_RETURN(auto heat, reader.heat_jobs(progress.name));
  report.heat = std::move(heat);
  ASSIGN_OR_RETURN(auto prediction, reader.prediction(progress.sweep_sha256));
  report.prediction = std::move(prediction);
  RETURN_IF_ERROR(reader.visit_errors(progress.name, [&](const StoredSignature& row) {
    report.rows.add(row);
    report.limits.add(row);
  }));
  for (const schema::Condition& condition : report.sweep.resolved.condition())
    for (const std::string& warning : condition.warning()) ++report.warnings[warning];
  ASSIGN_OR_RETURN(const auto outcome, reader.outcome(progress.name));
  report.back_faces = backface_text(outcome);
  report.images = image_text(outcome, report.sweep.resolved.sweep().image());
  return report;
}

double heat_cpu_s(const SweepReport& r) {
  double sum = 0;
  for (const StoredHeatJob& job : r.heat) sum += job.cpu_s;
  return sum;
}

void print_temperatures(std::ostream& out, const SweepReport& r) {
  if (r.heat.empty()) return;
  fmt::print(out, "temperatures: {} of {} jobs done, {} of CPU time, which no prediction counts\n",
             r.progress.heat_done, r.progress.heat_jobs, seconds_text(heat_cpu_s(r)));
  for (const StoredHeatJob& job : r.heat)
    for (const auto line : absl::StrSplit(job.warning, '\n', absl::SkipEmpty()))
      fmt::print(out, "warning (temperatures of \"{}\"): {}\n", job.season, std::string(line));
}

void print_sweep(std::ostream& out, const SweepReport& r, double bytes, std::size_t sweeps) {
  fmt::print(out, "{}: {} of {} jobs done, {} rows, {}\n", r.progress.name, r.progress.done,
             r.progress.jobs, r.rows.rows(), count_text(r.sums.rays, "rays"));
  for (const schema::Slice& slice : r.sweep.resolved.slice())
    fmt::print(out, "{}\n", slice_text(slice));
  if (const schema::ResolvedSweep& sweep = r.sweep.resolved; sweep.has_shard())
    fmt::print(out, "{} of the sweep {}: {} of {} viewpoints\n", shard_name(sweep.shard()),
               one_line(sweep.shard().sweep_sha256()), shard_size(sweep), sweep.viewpoint_size());
  print_temperatures(out, r);
  if (r.rows.superseded() > 0)
    fmt::print(out, "{} rows of an earlier version of the sweep wait for their replacement\n",
               r.rows.superseded());
  if (r.jobs.empty()) {
    fmt::print(out, "{} is done yet{}\n", r.heat.empty() ? "nothing" : "no view",
               r.prediction ? "; " + prediction_line(*r.prediction) : std::string());
    return;
  }
  print_cost(out, r.sums, r.prediction, bytes, sweeps);
  if (r.prediction && r.jobs.size() < r.progress.jobs - r.progress.heat_jobs)
    fmt::print(out, "  the sweep is not complete: what is predicted is for all {} {}\n",
               r.progress.jobs - r.progress.heat_jobs, r.heat.empty() ? "jobs" : "views");
  if (r.prediction && r.prediction->determinism_class != r.jobs.front().determinism_class)
    fmt::print(out, "  predicted on another machine or build: {}\n",
               r.prediction->determinism_class);
  print_errors(out, r.rows, r.sweep.resolved.sweep().accuracy());
  print_shares(out, r.rows);
  for (const std::string& note : r.limits.text()) fmt::print(out, "{}\n", note);
  if (!r.images.empty()) fmt::print(out, "{}\n", r.images);
  print_guards(out, r.sums);
  if (r.warnings.empty() && r.back_faces.empty()) fmt::print(out, "warnings: none\n");
  if (!r.back_faces.empty()) fmt::print(out, "warning: {}\n", r.back_faces);
  for (const auto& [warning, count] : r.warnings)
    fmt::print(out, "warning ({} condition{}): {}\n", count, count == 1 ? "" : "s", warning);
}

// Returns the report for programs: one line a sweep, each number in a column.
std::vector<std::pair<std::string, Cell>> columns_of(const SweepReport& r, std::uint64_t bytes) {
  std::vector<std::pair<std::string, Cell>> out;
  const auto add = [&](std::string name, Cell cell) {
    out.emplace_back(std::move(name), std::move(cell));
  };
  const auto number = [](double value) { return std::isfinite(value) ? Cell(value) : Cell(); };
  const auto both = [&](const std::string& name, auto StoredPrediction::*member, Cell real) {
    add("predicted_" + name, r.prediction ? Cell((*r.prediction).*member) : Cell());
    add(name, std::move(real));
  };
  const std::vector<double>& errors = r.rows.relative();
  std::map<std::string, std::uint64_t> stopped{{"accuracy_reached", 0},
                                               {"floor_reached", 0},
                                               {"accuracy_not_reached", 0},
                                               {"sample_limit", 0},
                                               {"fixed_samples", 0}};
  for (const auto& [reason, count] : r.rows.reasons()) stopped[reason] = count;
  const auto at = [&](const std::vector<double>& values, double share) {
    return values.empty() ? Cell() : number(quantile(values, share));
  };
  add("sweep", r.progress.name);
  add("sweep_sha256", r.progress.sweep_sha256);
  add("done", r.progress.done);
  both("jobs", &StoredPrediction::jobs, r.progress.jobs - r.progress.heat_jobs);
  add("rows", r.rows.rows());
  add("superseded_rows", r.rows.superseded());
  add("rays", r.sums.rays);
  both("job_cpu_median_s", &StoredPrediction::job_cpu_median_s, at(r.sums.cpu_s, 0.5));
  both("job_cpu_quartile1_s", &StoredPrediction::job_cpu_quartile1_s, at(r.sums.cpu_s, 0.25));
  both("job_cpu_quartile3_s", &StoredPrediction::job_cpu_quartile3_s, at(r.sums.cpu_s, 0.75));
  both("cpu_s", &StoredPrediction::cpu_s, r.sums.total_s);
  both("wall_s", &StoredPrediction::wall_s, number(r.sums.wall_s));
  add("predicted_workers", r.prediction ? Cell(r.prediction->workers) : Cell());
  both("database_bytes", &StoredPrediction::database_bytes, bytes);
  const schema::Accuracy& accuracy = r.sweep.resolved.sweep().accuracy();
  add("relative_error_asked",
      accuracy.has_relative_error() ? Cell(accuracy.relative_error()) : Cell());
  add("relative_error_median", at(errors, 0.5));
  add("relative_error_quantile_90", at(errors, 0.9));
  add("relative_error_quantile_99", at(errors, 0.99));
  add("relative_error_largest", at(errors, 1));
  for (const auto& [reason, count] : stopped) add(reason + "_rows", count);
  for (const ErrorShare& share : r.rows.shares()) {
    std::string name = share.what;
    std::replace(name.begin(), name.end(), ' ', '_');
    add("error_share_" + name, share.mean);
  }
  add("guarded_backface_hits", r.sums.backface);
  add("guarded_nonfinite", r.sums.nonfinite);
  add("truncated_paths", r.sums.path_limit);
  add("heat_jobs", r.progress.heat_jobs);
  add("heat_done", r.progress.heat_done);
  add("heat_cpu_s", heat_cpu_s(r));
  std::vector<std::string> warnings;
  for (const StoredHeatJob& job : r.heat)
    if (!job.warning.empty()) warnings.push_back(job.warning);
  if (!r.back_faces.empty()) warnings.push_back(r.back_faces);
  for (const auto& [warning, count] : r.warnings) warnings.push_back(warning);
  add("warning", absl::StrJoin(warnings, "\n"));
  return out;
}

absl::Status write_report(const std::vector<SweepReport>& reports, std::uint64_t bytes,
                          std::string_view format, std::ostream& out) {
  if (format == "text") {
    for (const SweepReport& r : reports) {
      if (&r != &reports.front()) fmt::print(out, "\n");
      print_sweep(out, r, static_cast<double>(bytes), reports.size());
    }
    return absl::OkStatus();
  }
  // A column that one sweep has (a share of an error) has no value in the others.
  std::vector<Column> heads;
  std::vector<std::map<std::string, Cell>> lines;
  for (const SweepReport& r : reports) {
    auto& line = lines.emplace_back();
    for (auto& [name, cell] : columns_of(r, bytes)) {
      if (std::none_of(heads.begin(), heads.end(),
                       [&, &wanted = name](const Column& c) { return c.name == wanted; }))
        heads.push_back({name});
      line[name] = std::move(cell);
    }
  }
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, heads, out));
  for (auto& line : lines) {
    std::vector<Cell> cells;
    for (const Column& c : heads) cells.push_back(line[c.name]);
    writer->row(cells);
  }
  return writer->finish();
}

absl::Status report_database(const std::string& db_path, const OutputOptions& output) {
  ASSIGN_OR_RETURN(auto reader, StoreReader::open(db_path));
  ASSIGN_OR_RETURN(const auto bytes, reader->bytes());
  ASSIGN_OR_RETURN(const auto sweeps, reader->progress());
  if (sweeps.empty()) print_note("irsig: {} holds no sweep\n", db_path);
  std::vector<SweepReport> reports;
  for (const SweepProgress& progress : sweeps) {
    ASSIGN_OR_RETURN(auto report, gather(*reader, progress));
    reports.push_back(std::move(report));
  }
  return output.write([&](std::string_view format, std::ostream& out) {
    return write_report(reports, bytes, format, out);
  });
}

}  // namespace

void add_report(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "report",
      "Compare what a run took with what was predicted, and print errors, bounds and "
      "warnings. It ends with what keeps rows from their accuracy, and the key that lowers "
      "it.");
  auto db_path = std::make_shared<std::string>();
  command->add_option("DB", *db_path, "the database")->required();
  auto output =
      std::make_shared<OutputOptions>(*command, std::vector<std::string>{"text", "csv", "json"});
  command->callback([=, &exit_code] { exit_code = report(report_database(*db_path, *output)); });
  command->footer(
      "A prediction is stored by `irsig plan SWEEP --db DB` or `irsig run --plan`, for the very\n"
      "same sweep and accuracy.");
}

}  // namespace irsig
