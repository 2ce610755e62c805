#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/accuracy_options.h"
#include "cli/commands.h"
#include "cli/loading.h"
#include "cli/output_options.h"
#include "core/accuracy/measured.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "fmt/ostream.h"
#include "fmt/ranges.h"
#include "planning/amount_text.h"
#include "planning/machine.h"
#include "planning/prediction.h"
#include "planning/time_budget.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"
#include "view/base/table.h"
#include "view/plot/plot_frame.h"
#include "view/report/outcome.h"
#include "view/report/refine_tables.h"

namespace irsig {
namespace {

struct PlanAsked {
  explicit PlanAsked(CLI::App& command) : output(command, {"text", "csv", "json"}) {}
  std::string sweep_path, db_path;
  std::uint32_t workers = 0;
  AccuracyAsked accuracy;
  OutputOptions output;
  std::string refine_db, refine_sweep, refine_quantity = "intensity", refine_left_out;
  std::optional<double> refine_range_m;
  double refine_error = 0.05;
  std::size_t refine_most = 1000;
};

constexpr double kTablePercent[] = {10, 3, 1, 0.3, 0.1, 0.03};

std::string accuracy_text(const schema::Accuracy& accuracy) {
  if (accuracy.has_target_paths())
    return fmt::format("{:g} paths that meet the target", accuracy.target_paths());
  if (accuracy.has_samples_per_replicate())
    return fmt::format("{} samples in each of {} replicates", accuracy.samples_per_replicate(),
                       accuracy.replicates());
  return fmt::format("{:g} % of every in-band intensity", 100 * accuracy.relative_error());
}

// Why rows do not reach an error; empty: all do.
std::string what_keeps(const SweepCost& cost, std::uint64_t max_samples, double floor_k) {
  std::string text;
  if (cost.at_floor_fraction > 0)
    text += fmt::format("; {:.3g} % stop above it, at the floor of {:g} K (floor_reached)",
                        100 * cost.at_floor_fraction, floor_k);
  if (cost.kept_by_bias_fraction > 0)
    text += fmt::format("; bias bounds keep {:.3g} % above it", 100 * cost.kept_by_bias_fraction);
  if (cost.kept_by_limit_fraction > 0)
    text += fmt::format("; max_samples_per_replicate = {} keeps {:.3g} %", max_samples,
                        100 * cost.kept_by_limit_fraction);
  const double otherwise = 1 - cost.reached_fraction - cost.at_floor_fraction -
                           cost.kept_by_bias_fraction - cost.kept_by_limit_fraction;
  if (otherwise > 1e-9)
    text += fmt::format("; {:.3g} % miss it: the pilots ask for too few samples", 100 * otherwise);
  return text;
}

// The parts of errors that keep rows above the error that was asked for, the most frequent first:
// "12 rows would not reach 2 %: temperatures of large facets (temperature); set [heat] ...". The
// pilot's rows stand for all rows.
std::vector<std::string> limiting_lines(const SweepCost& cost, std::uint64_t rows,
                                        double relative_error) {
  std::vector<std::pair<std::string_view, double>> sorted(cost.limited_fraction.begin(),
                                                          cost.limited_fraction.end());
  std::ranges::stable_sort(sorted, std::greater<>(), &std::pair<std::string_view, double>::second);
  std::vector<std::string> out;
  for (const auto& [part, fraction] : sorted) {
    const bool of_samples = part == kLimitedBySampling || part == info_of(BoundOf::kUnseen).name;
    const auto count = std::max(1.0, std::round(fraction * static_cast<double>(rows)));
    out.push_back(fmt::format("{:.0f} row{} would not reach {:g} %: {}", count,
                              count == 1 ? "" : "s", 100 * relative_error,
                              limit_text(part, of_samples && cost.kept_by_limit_fraction > 0)));
  }
  return out;
}

void print_table(std::ostream& out, const SweepPilot& pilot, std::uint32_t workers,
                 double floor_k) {
  if (pilot.rule.relative_error <= 0) {
    fmt::print(out, "\nFor the table of time against error, ask with --relative-error.\n");
    return;
  }
  fmt::print(out,
             "\nrelative error -> median samples a replicate, CPU time, wall time on {} worker{}, "
             "rows that reach it\n",
             workers, workers == 1 ? "" : "s");
  for (const double percent : kTablePercent) {
    CountRule rule = pilot.rule;
    rule.relative_error = percent / 100;
    const SweepCost cost = sweep_cost(view_costs(pilot, rule), pilot.views, pilot.jobs_per_view,
                                      workers, pilot.start_s);
    fmt::print(out, "{:>6g} % {:>10.0f} {:>10} {:>10} {:>6.3g} %{}\n", percent, cost.median_samples,
               seconds_text(cost.cpu_s), seconds_text(cost.wall_s), 100 * cost.reached_fraction,
               what_keeps(cost, rule.max_samples_per_replicate, floor_k));
  }
}

// The pilot's rows have the effects that the asked accuracy calls for.
void print_effects(std::ostream& out, const SweepPilot& pilot) {
  const auto summary = summarize_effects(pilot.ledger);
  fmt::print(
      out,
      "\neffects in the pilot's {} rows, for the accuracy asked; bounds relative to the intensity; "
      "times of its\n{} view{}, estimated\n{}",
      pilot.ledger.size(), pilot.view.size(), pilot.view.size() == 1 ? "" : "s",
      summary_table(summary));
  double saved_s = 0;
  for (const EffectSummary& effect : summary)
    if (!std::isnan(effect.saved_s)) saved_s += effect.saved_s;
  const double views = static_cast<double>(pilot.views) / static_cast<double>(pilot.view.size());
  if (saved_s > 0)
    fmt::print(out,
               "what is off saves an estimated {} of CPU time or more in all {} views, at the "
               "pilot's samples\n",
               seconds_text(views * saved_s), pilot.views);
}

void print_plan(std::ostream& out, const LoadedSweep& loaded, const SweepPilot& pilot,
                const StoredPrediction& p) {
  const schema::ResolvedSweep& sweep = loaded.resolved;
  const double floor_k = sweep.sweep().accuracy().absolute_error_k();
  const auto workers = static_cast<std::uint32_t>(p.workers);
  const SweepCost cost = sweep_cost(view_costs(pilot, pilot.rule), pilot.views, pilot.jobs_per_view,
                                    workers, pilot.start_s);
  fmt::print(out, "{}: {}, in {} job{}\n", sweep.sweep().name(), rows_text(loaded.size), p.jobs,
             p.jobs == 1 ? "" : "s");
  if (sweep.heat_size() > 0)
    fmt::print(out,
               "before     {} job{} that compute{} temperatures, which every view needs: not "
               "part of the times below\n",
               sweep.heat_size(), sweep.heat_size() == 1 ? "" : "s",
               sweep.heat_size() == 1 ? "s" : "");
  fmt::print(out, "asked      {}\n", accuracy_text(sweep.sweep().accuracy()));
  fmt::print(
      out, "job        {} of CPU time (median; quartiles {} and {}), {:.0f} samples a replicate\n",
      seconds_text(p.job_cpu_median_s), seconds_text(p.job_cpu_quartile1_s),
      seconds_text(p.job_cpu_quartile3_s), cost.median_samples);
  fmt::print(out, "CPU time   {}\n", seconds_text(p.cpu_s));
  fmt::print(out, "wall time  {} on {} worker{}\n", seconds_text(p.wall_s), p.workers,
             p.workers == 1 ? "" : "s");
  fmt::print(out, "memory     {}\n", memory_text(loaded.memory, loaded.size.conditions, workers));
  fmt::print(out, "database   {}\n", bytes_text(static_cast<double>(p.database_bytes)));
  if (pilot.rule.relative_error > 0)
    fmt::print(out, "rows that reach the error asked for: {:.3g} %{}\n",
               100 * cost.reached_fraction,
               what_keeps(cost, pilot.rule.max_samples_per_replicate, floor_k));
  fmt::print(out, "pilot      {} viewpoint{}, {} of CPU time\n", p.pilot_viewpoints,
             p.pilot_viewpoints == 1 ? "" : "s", seconds_text(p.pilot_cpu_s));
  print_table(out, pilot, workers, floor_k);
  print_effects(out, pilot);
  const std::vector<std::string> limits =
      limiting_lines(cost, loaded.size.rows(), pilot.rule.relative_error);
  if (!limits.empty()) fmt::print(out, "\n{}\n", fmt::join(limits, "\n"));
}

// Returns the most frequent limit among the rows that miss the accuracy. An empty cell means that
// no row misses it.
Cell most_frequent(const SweepCost& cost) {
  const auto& limits = cost.limited_fraction;
  const auto most =
      std::ranges::max_element(limits, {}, &std::map<std::string_view, double>::value_type::second);
  return most == limits.end() ? Cell() : Cell(std::string(most->first));
}

// For programs: a line for what is asked, and one for each error of the table.
absl::Status write_rows(const LoadedSweep& loaded, const SweepPilot& pilot,
                        const StoredPrediction& p, std::string_view format, std::ostream& out) {
  const std::vector<Column> heads = {{"sweep"},
                                     {"asked"},
                                     {"relative_error"},
                                     {"viewpoints"},
                                     {"conditions"},
                                     {"bands"},
                                     {"rows"},
                                     {"jobs"},
                                     {"workers"},
                                     {"samples_median"},
                                     {"job_cpu_median_s"},
                                     {"cpu_s"},
                                     {"wall_s"},
                                     {"memory_bytes"},
                                     {"database_bytes"},
                                     {"reached_fraction"},
                                     {"at_floor_fraction"},
                                     {"kept_by_bias_fraction"},
                                     {"kept_by_limit_fraction"},
                                     {"heat_jobs"},
                                     {"limiting_bound"}};
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, heads, out));
  const auto workers = static_cast<std::uint32_t>(p.workers);
  const SweepSize& size = loaded.size;
  const auto line = [&](const CountRule& rule, bool asked) {
    const SweepCost cost = sweep_cost(view_costs(pilot, rule), pilot.views, pilot.jobs_per_view,
                                      workers, pilot.start_s);
    const bool by_error = rule.relative_error > 0;
    const auto share = [&](double value) { return by_error ? Cell(value) : Cell(); };
    writer->row({loaded.resolved.sweep().name(),
                 asked,
                 share(rule.relative_error),
                 size.viewpoints,
                 size.conditions,
                 size.bands,
                 size.rows(),
                 p.jobs,
                 p.workers,
                 cost.median_samples,
                 cost.job_cpu_median_s,
                 cost.cpu_s,
                 cost.wall_s,
                 loaded.memory.bytes(size.conditions, workers),
                 p.database_bytes,
                 share(cost.reached_fraction),
                 share(cost.at_floor_fraction),
                 share(cost.kept_by_bias_fraction),
                 share(cost.kept_by_limit_fraction),
                 std::uint64_t{static_cast<std::uint64_t>(loaded.resolved.heat_size())},
                 most_frequent(cost)});
  };
  line(pilot.rule, true);
  if (pilot.rule.relative_error > 0)
    for (const double percent : kTablePercent) {
      CountRule rule = pilot.rule;
      rule.relative_error = percent / 100;
      line(rule, false);
    }
  return writer->finish();
}

// Viewpoints that interpolation needs, as lines for the sweep file.
absl::Status plan_refinement(const PlanAsked& asked) {
  if (!asked.sweep_path.empty())
    return absl::InvalidArgumentError("--refine reads a database: no SWEEP with it");
  const double error = asked.refine_error;
  if (!(error > 0 && error <= 1))
    return absl::InvalidArgumentError(
        fmt::format("--interpolation-error {:g}: expected more than 0, at most 1", error));
  Query query;
  query.sweep = asked.refine_sweep;
  query.at_range_m = asked.refine_range_m;
  ASSIGN_OR_RETURN(const auto quantity, quantity_named(asked.refine_quantity));
  query.quantity = quantity;
  ASSIGN_OR_RETURN(auto reader, StoreReader::open(asked.refine_db));
  ASSIGN_OR_RETURN(const auto rows, signatures_to_plot(*reader, query, {}));
  const auto fields = fields_of(rows, quantity);
  for (const SignatureField& f : fields)
    if (f.signature.size() != fields.front().signature.size())
      return absl::FailedPreconditionError(fmt::format(
          "{} {} {} has {} viewpoints, others have {}: the sweep is not complete",
          f.signature.front().season, f.signature.front().time_utc, f.signature.front().band,
          f.signature.size(), fields.front().signature.size()));
  const FieldKind kind = kind_of(quantity);
  if (const std::string& file = asked.refine_left_out; !file.empty()) {
    if (!file.ends_with(".csv"))
      return absl::InvalidArgumentError(
          fmt::format("--left-out {}: expected a name that ends in .csv", file));
    const auto written = replace_file(file, [&](const std::string& name) {
      std::ofstream out(name, std::ios::binary);
      return write_left_out(fields, kind, "csv", out);
    });
    if (!written.ok()) return written;
  }
  ASSIGN_OR_RETURN(const auto found, refine(fields, kind, error, asked.refine_most));
  for (const std::string& note : notes_on(found, fields, quantity, error))
    print_note("irsig: note: {}\n", note);
  if (found.add.empty()) return absl::OkStatus();
  return asked.output.write([&](std::string_view format, std::ostream& out) {
    return write_proposed(found, fields, format, out);
  });
}

absl::Status plan_sweep(const PlanAsked& asked) {
  if (!asked.refine_db.empty()) return plan_refinement(asked);
  if (asked.sweep_path.empty())
    return absl::InvalidArgumentError("SWEEP is missing, or --refine DB");
  // A file that is no database is refused before the pilot.
  if (!asked.db_path.empty() && std::filesystem::exists(asked.db_path))
    RETURN_IF_ERROR(StoreReader::open(asked.db_path).status());
  ASSIGN_OR_RETURN(auto loaded, load_shown(asked.sweep_path, asked.accuracy));
  for (const std::string& line : loaded.warnings) print_note("{}\n", line);
  print_note("irsig: {}\n", size_text(loaded.size));
  const std::uint32_t workers = asked.workers > 0 ? asked.workers : usable_cores();
  RETURN_IF_ERROR(
      check_memory(loaded.memory, loaded.size.conditions, workers, usable_memory_bytes()));
  if (has_time_budget(loaded.resolved)) {
    ASSIGN_OR_RETURN(const auto spent, spend_shown(loaded, workers));
    print_note("irsig: {}\n", spent);
  }
  ASSIGN_OR_RETURN(const auto pilot, pilot_sweep(loaded));
  const StoredPrediction p = prediction_of(pilot, loaded.resolved, workers);
  const absl::Status written =
      asked.output.write([&](std::string_view format, std::ostream& out) -> absl::Status {
        if (format != "text") return write_rows(loaded, pilot, p, format, out);
        print_plan(out, loaded, pilot, p);
        return absl::OkStatus();
      });
  if (!written.ok()) return written;
  if (asked.db_path.empty()) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto stored, store_in(asked.db_path, p));
  if (!stored.empty()) print_note("irsig: warning: {}\n", stored);
  return absl::OkStatus();
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "plan",
      "Predict a run: jobs, rows, database size, CPU and wall time, and time against error. "
      "It ends with what would keep rows from their accuracy, and the key that lowers it.");
  auto asked = std::make_shared<PlanAsked>(*command);
  command->add_option("SWEEP", asked->sweep_path, "the sweep file");
  add_accuracy_options(*command, asked->accuracy, asked->workers);
  add_shard_option(*command, asked->accuracy);
  command->add_option("--db", asked->db_path,
                      "store the prediction here for `irsig report`; made if it does not exist");
  auto* refine =
      command
          ->add_option("--refine", asked->refine_db,
                       "instead: the viewpoints that this database lacks for an interpolation "
                       "between them to --interpolation-error, as lines for the sweep file")
          ->type_name("DB");
  const auto of_refine = [&](CLI::Option* option) { option->needs(refine); };
  of_refine(command
                ->add_option("--interpolation-error", asked->refine_error,
                             "one sigma, as a share of the value beside it (of the contrast: of "
                             "its rms)")
                ->type_name("SHARE")
                ->capture_default_str());
  of_refine(command->add_option("--most", asked->refine_most, "no more viewpoints than these")
                ->type_name("N")
                ->check(CLI::Range(1, 100000))
                ->capture_default_str());
  of_refine(command->add_option("--sweep", asked->refine_sweep, "Name of the sweep, of several"));
  of_refine(command
                ->add_option("--at-range-m", asked->refine_range_m,
                             "Only viewpoints at this range, of several")
                ->type_name("R"));
  of_refine(command
                ->add_option("--quantity", asked->refine_quantity,
                             "intensity, apparent_intensity, contrast_intensity or "
                             "background_radiance")
                ->type_name("QUANTITY")
                ->check(CLI::IsMember(quantity_names()))
                ->capture_default_str());
  of_refine(command
                ->add_option("--left-out", asked->refine_left_out,
                             "each viewpoint as the others have it, with the error that this "
                             "states (.csv)")
                ->type_name("FILE"));
  command->callback([=, &exit_code] { exit_code = report(plan_sweep(*asked)); });
  command->footer(
      "A few viewpoints are computed with few samples by a worker of this machine, and thrown\n"
      "away. Times are those of this machine; `irsig report` sets them against the run's.");
}

}  // namespace irsig
