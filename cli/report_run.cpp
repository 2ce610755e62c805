#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "coordinator/client/progress_text.h"
#include "core/accuracy/cost_model.h"
#include "fmt/format.h"
#include "planning/prediction.h"
#include "view/measured_row.h"
#include "view/outcome.h"
#include "view/print.h"

namespace irsig {
namespace {

// One line of the comparison; the ratio is predicted / real.
void print_line(const char* what, const std::optional<double>& predicted, double real,
                std::string (*text)(double)) {
  if (!predicted) {
    print_text("  {:<24} {:>12} {:>12}\n", what, "-", text(real));
    return;
  }
  print_text("  {:<24} {:>12} {:>12} {:>7.2f}\n", what, text(*predicted), text(real),
             real > 0 ? *predicted / real : NAN);
}

std::string whole(double count) { return fmt::format("{:.0f}", count); }

void print_cost(const std::vector<StoredJobCost>& jobs, const std::optional<StoredPrediction>& p,
                double bytes, std::size_t sweeps) {
  std::vector<double> cpu_s;
  double total_s = 0, first_s = INFINITY, last_s = 0;
  for (const StoredJobCost& job : jobs) {
    cpu_s.push_back(job.cpu_s);
    total_s += job.cpu_s;
    first_s = std::min(first_s, job.leased_unix_s);
    last_s = std::max(last_s, job.leased_unix_s + job.cpu_s);
  }
  const auto of = [&](auto member) {
    return p ? std::optional<double>(static_cast<double>((*p).*member)) : std::nullopt;
  };
  print_text("  {:<24} {:>12} {:>12} {:>7}\n", "", p ? "predicted" : "no prediction", "real",
             p ? "ratio" : "");
  print_line("jobs", of(&StoredPrediction::jobs), static_cast<double>(jobs.size()), whole);
  print_line("median job, CPU time", of(&StoredPrediction::job_cpu_median_s), quantile(cpu_s, 0.5),
             seconds_text);
  print_line("  first quartile", of(&StoredPrediction::job_cpu_quartile1_s), quantile(cpu_s, 0.25),
             seconds_text);
  print_line("  third quartile", of(&StoredPrediction::job_cpu_quartile3_s), quantile(cpu_s, 0.75),
             seconds_text);
  print_line("CPU time of all jobs", of(&StoredPrediction::cpu_s), total_s, seconds_text);
  print_line("wall time", of(&StoredPrediction::wall_s), last_s - first_s, seconds_text);
  print_line(sweeps > 1 ? "database (all sweeps)" : "database",
             of(&StoredPrediction::database_bytes), bytes, bytes_text);
  print_text(
      "  wall time: from the first lease to the end of the last job, pauses of an interrupted run "
      "included{}\n",
      p ? fmt::format("; predicted for {} worker{}, their start included", p->workers,
                      p->workers == 1 ? "" : "s")
        : "");
}

void print_errors(const std::vector<StoredSignature>& rows, const schema::Accuracy& accuracy) {
  std::vector<double> errors;
  std::map<std::string, std::uint64_t> reasons;
  std::uint64_t without_value = 0;
  for (const StoredSignature& row : rows) {
    ++reasons[row.stop_reason];
    if (row.intensity_w_sr != 0)
      errors.push_back(100 * row.numerical_error_w_sr / std::abs(row.intensity_w_sr));
    else
      ++without_value;
  }
  if (accuracy.has_relative_error())
    print_text("\nrelative error asked: {:g} %\n", 100 * accuracy.relative_error());
  else
    print_text("\nno relative error was asked for: the number of samples was given\n");
  if (!errors.empty())
    print_text(
        "numerical error / intensity: median {:.3g} %, 10 % of rows below {:.3g} %, 10 % above "
        "{:.3g} %, 1 % above {:.3g} %, largest {:.3g} %\n",
        quantile(errors, 0.5), quantile(errors, 0.1), quantile(errors, 0.9), quantile(errors, 0.99),
        quantile(errors, 1));
  if (without_value > 0) print_text("rows of intensity 0: {}\n", without_value);
  print_text("stopped by:");
  for (const auto& [reason, count] : reasons) print_text(" {} {}", reason, count);
  print_text("\n");
  if (reasons.contains("floor_reached"))
    print_text("floor_reached: not the relative error, but the floor of {:g} K\n",
               accuracy.absolute_error_k());
}

// What each bound brings to the square of the numerical error of the source intensity.
void print_shares(const std::vector<StoredSignature>& rows) {
  struct Share {
    std::string what;
    double sum = 0, largest = 0;
  };
  // At the target itself neither depth nor another range counts.
  constexpr std::size_t kAtTarget = static_cast<std::size_t>(BoundOf::kDepth);
  std::vector<Share> shares{{"statistical"}, {"unseen hits"}};
  for (std::size_t i = 0; i < kAtTarget; ++i)
    shares.push_back({std::string(info_of(static_cast<BoundOf>(i)).name)});
  double counted = 0;
  bool all_known = true;
  for (const StoredSignature& row : rows) {
    const Measured source = source_of(row);
    if (!(source.numerical_error() > 0)) continue;
    all_known &= !std::isnan(row.basis_bound_w_sr);
    ++counted;
    const auto add = [&](Share& share, double part) {
      share.sum += part;
      share.largest = std::max(share.largest, part);
    };
    add(shares[0], source.sampled_share());
    add(shares[1], source.unseen_share());
    for (std::size_t i = 0; i < kAtTarget; ++i)
      add(shares[i + 2], source.share(static_cast<BoundOf>(i)));
  }
  if (counted == 0) return;
  print_text("share of the numerical error's square, mean over the rows (largest):\n ");
  for (const Share& share : shares)
    print_text(" {} {:.3g} % ({:.3g} %)", share.what, 100 * share.sum / counted,
               100 * share.largest);
  print_text("\n");
  if (!all_known)
    print_text("  some rows are of an older format, which did not keep every bound apart\n");
}

void print_guards(const std::vector<StoredJobCost>& jobs) {
  std::uint64_t backface = 0, nonfinite = 0, negative = 0, limit = 0, uncounted = 0;
  for (const StoredJobCost& job : jobs) {
    backface += job.guarded_backface_hits;
    nonfinite += job.guarded_nonfinite;
    limit += job.guarded_path_limit;
    if (job.guarded_negative)
      negative += *job.guarded_negative;
    else
      ++uncounted;
  }
  print_text("guarded events: back faces {}, not finite {}, negative {}{}\n", backface, nonfinite,
             negative, uncounted > 0 ? fmt::format(" ({} jobs did not count)", uncounted) : "");
  print_text("paths alive after the last reflection: {}\n", limit);
}

absl::Status report_sweep(StoreReader& reader, const SweepProgress& progress, double bytes,
                          std::size_t sweeps) {
  const auto sweep = reader.sweep(progress.name);
  if (!sweep.ok()) return sweep.status();
  const auto jobs = reader.job_costs(progress.name);
  if (!jobs.ok()) return jobs.status();
  const auto prediction = reader.prediction(progress.sweep_sha256);
  if (!prediction.ok()) return prediction.status();
  SignatureFilter filter;
  filter.sweep = progress.name;
  auto rows = reader.find(filter);
  if (!rows.ok()) return rows.status();
  const std::size_t stored = rows->size();
  std::erase_if(*rows, [](const StoredSignature& row) { return row.superseded; });
  double rays = 0;
  for (const StoredJobCost& job : *jobs) rays += static_cast<double>(job.rays);
  print_text("{}: {} of {} jobs done, {} rows, {}\n", progress.name, progress.done, progress.jobs,
             rows->size(), count_text(rays, "rays"));
  if (rows->size() < stored)
    print_text("{} rows of an earlier version of the sweep wait for their replacement\n",
               stored - rows->size());
  if (jobs->empty()) {
    print_text("nothing is done yet{}\n",
               *prediction ? "; " + prediction_line(**prediction) : std::string());
    return absl::OkStatus();
  }
  print_cost(*jobs, *prediction, bytes, sweeps);
  if (*prediction && jobs->size() < progress.jobs)
    print_text("  the sweep is not complete: what is predicted is for all {} jobs\n",
               progress.jobs);
  if (*prediction && (*prediction)->determinism_class != jobs->front().determinism_class)
    print_text("  predicted on another machine or build: {}\n", (*prediction)->determinism_class);
  print_errors(*rows, sweep->resolved.sweep().accuracy());
  print_shares(*rows);
  print_guards(*jobs);
  std::map<std::string, std::uint64_t> warnings;
  for (const schema::Condition& condition : sweep->resolved.condition())
    for (const std::string& warning : condition.warning()) ++warnings[warning];
  const auto outcome = reader.outcome(progress.name);
  if (!outcome.ok()) return outcome.status();
  const std::string back_faces = backface_text(*outcome);
  if (warnings.empty() && back_faces.empty()) print_text("warnings: none\n");
  if (!back_faces.empty()) print_text("warning: {}\n", back_faces);
  for (const auto& [warning, count] : warnings)
    print_text("warning ({} condition{}): {}\n", count, count == 1 ? "" : "s", warning);
  return absl::OkStatus();
}

absl::Status report_database(const std::string& db_path) {
  auto reader = StoreReader::open(db_path);
  if (!reader.ok()) return reader.status();
  const auto bytes = (*reader)->bytes();
  if (!bytes.ok()) return bytes.status();
  const auto sweeps = (*reader)->progress();
  if (!sweeps.ok()) return sweeps.status();
  if (sweeps->empty()) print_text("{} holds no sweep\n", db_path);
  for (std::size_t i = 0; i < sweeps->size(); ++i) {
    if (i > 0) print_text("\n");
    if (auto status =
            report_sweep(**reader, (*sweeps)[i], static_cast<double>(*bytes), sweeps->size());
        !status.ok())
      return status;
  }
  return absl::OkStatus();
}

}  // namespace

void add_report(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "report", "after a run: what it took against what was predicted, errors, bounds, warnings");
  auto db_path = std::make_shared<std::string>();
  command->add_option("DB", *db_path, "the database")->required();
  command->callback([=, &exit_code] { exit_code = report(report_database(*db_path)); });
  command->footer(
      "A prediction is stored by `irsig plan SWEEP --db DB` or `irsig run --plan`, for the very\n"
      "same sweep and accuracy.");
}

}  // namespace irsig
