#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/commands.h"
#include "core/accuracy/cost_model.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "planning/effects_check.h"
#include "planning/load_sweep.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"
#include "view/study_tables/effects_tables.h"

namespace irsig {
namespace {

struct VerifyOptions {
  std::string sweep, values;
  std::uint64_t views = 5;
  std::vector<std::uint64_t> row;
  bool matrix = false, small = false, each_effect = false;
  std::optional<double> relative_error, reference;
  std::uint32_t timed = 1;
};

double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

absl::Status verify_sweep(const VerifyOptions& given, int& exit_code) {
  AccuracyAsked asked;
  asked.relative_error = given.relative_error;
  ASSIGN_OR_RETURN(auto loaded, load_sweep(given.sweep, asked));
  RETURN_IF_ERROR(have_temperatures(loaded));
  const schema::ResolvedSweep& sweep = loaded.resolved;
  bool first = true;
  std::string failures;
  const auto show = [&](const CheckedView& view) {
    if (first)
      print_text("{}: relative error {:g}, effects auto against all, the same paths\n{}\n",
                 sweep.sweep().name(), sweep.sweep().accuracy().relative_error(),
                 effects_view_header());
    first = false;
    print_text("{}\n", effects_view_line(view));
    std::fflush(stdout);
    failures += effects_failures(sweep.sweep().name(), view);
  };
  ASSIGN_OR_RETURN(const auto checked,
                   check_sweep_effects(
                       loaded, {given.views, given.row, given.timed, given.reference.value_or(0)},
                       thread_cpu_s, show));
  std::vector<double> ratios;
  for (const CheckedView& view : checked)
    ratios.push_back(view.all_s > 0 ? view.chosen_s / view.all_s : 1);
  const EffectsSummary s = summary_of(checked);
  std::printf(
      "%zu views, %zu rows, %zu values: %zu out of bound, largest difference %.3f of what is "
      "allowed\ntime auto/all: median %.2f; first view with what all views share %.3g s against "
      "%.3g s\n%s\n",
      s.views, s.rows, s.values, s.out_of_bound, s.largest_of_allowed, quantile(ratios, 0.5),
      s.chosen_first_s, s.all_first_s, effects_off(s).c_str());
  if (s.referenced > 0)
    std::printf(
        "against the reference: %zu values, %zu beyond 2 numerical errors, %zu beyond 5, largest "
        "%.2f\n",
        s.referenced, s.beyond_2, s.beyond_5, s.largest_of_numerical_error);
  print_plain(stdout, failures);
  exit_code = s.out_of_bound == 0 ? 0 : 1;
  return absl::OkStatus();
}

// Every effect left out alone, wherever there is something of it: are the bounds right, and how far
// from what they bound?
absl::Status verify_bounds(const std::vector<MatrixCell>& cells, MatrixOptions options,
                           int& exit_code) {
  options.reference_paths = 0;
  std::string failures;
  std::printf("%s", effect_bounds_header().c_str());
  for (std::size_t e = 0; e < kEffectCount; ++e) {
    const EffectInfo& info = info_of(static_cast<Effect>(e));
    if (!info.switchable || is_of_heat(info.effect) || is_of_cloud(info.effect)) continue;
    options.without = info.effect;
    std::vector<CheckedCell> checked;
    for (const MatrixCell& cell : cells) {
      if (is_of_plume(info.effect) && !cell.has_gas()) continue;
      auto result = check_cell(cell, options, thread_cpu_s);
      if (absl::IsFailedPrecondition(result.status())) {
        // The program refuses: no finite bound is known, so that there is none to compare with.
        failures += fmt::format("{}: {}\n", cell.name, std::string(result.status().message()));
        continue;
      }
      if (!result.ok())
        return {result.status().code(), absl::StrCat(cell.name, ": ", result.status().message())};
      for (const CheckedView& view : result->view)
        failures +=
            effects_failures(absl::StrCat(cell.name, " without ", std::string(info.name)), view);
      if (result->summary.out_of_bound > 0) exit_code = 1;
      checked.push_back(*std::move(result));
    }
    std::printf("%s", effect_bounds_line(info.effect, checked).c_str());
    std::fflush(stdout);
  }
  print_plain(stdout, failures);
  return absl::OkStatus();
}

absl::Status verify_matrix(const VerifyOptions& given, int& exit_code) {
  ASSIGN_OR_RETURN(const auto cells, matrix_cells(given.small));
  MatrixOptions options;
  options.relative_error = given.relative_error.value_or(options.relative_error);
  options.reference_paths = given.reference.value_or(options.reference_paths);
  options.timed = given.timed;
  if (given.each_effect) return verify_bounds(cells, options, exit_code);
  std::printf("relative error %g, effects auto against all, the same paths\n%s\n",
              options.relative_error, effects_cell_header().c_str());
  std::vector<CheckedCell> checked;
  std::string failures;
  std::size_t bad = 0;
  for (const MatrixCell& cell : cells) {
    auto result = check_cell(cell, options, thread_cpu_s);
    if (!result.ok())
      return {result.status().code(), absl::StrCat(cell.name, ": ", result.status().message())};
    print_text("{}\n", effects_cell_line(cell, *result));
    std::fflush(stdout);
    for (const CheckedView& view : result->view) failures += effects_failures(cell.name, view);
    bad += result->summary.out_of_bound > 0 ? 1 : 0;
    checked.push_back(*std::move(result));
  }
  std::printf("\n%s%s", effects_matrix_summary(cells, checked).c_str(), failures.c_str());
  if (!given.values.empty())
    RETURN_IF_ERROR(replace_file(given.values, effects_csv(cells, checked)));
  exit_code = bad == 0 ? 0 : 1;
  return absl::OkStatus();
}

int verify(const VerifyOptions& given) {
  const bool both = given.matrix && (!given.sweep.empty() || !given.row.empty());
  if (both || (!given.matrix && given.sweep.empty()))
    return report(absl::InvalidArgumentError(
        "verify-effects: expected a sweep file, or --matrix for the built-in scenes"));
  if (!given.matrix && (given.small || given.each_effect || !given.values.empty()))
    return report(absl::InvalidArgumentError(
        "verify-effects: --small, --each-effect and --values need --matrix"));
  if (given.each_effect && !given.values.empty())
    return report(absl::InvalidArgumentError("verify-effects: --values is not for --each-effect"));
  int exit_code = 0;
  print_text("{}\n", kNotSeenByEffects);
  const absl::Status status =
      given.matrix ? verify_matrix(given, exit_code) : verify_sweep(given, exit_code);
  return status.ok() ? exit_code : report(status);
}

}  // namespace

void add_verify_effects(CLI::App& app, int& exit_code) {
  const auto given = std::make_shared<VerifyOptions>();
  CLI::App* command = app.add_subcommand(
      "verify-effects",
      "Compare the effects that the program chose with all effects on the same paths: "
      "differences, stored bounds, times. Exit code 1: a difference is out of bound.");
  command->add_option("SWEEP", given->sweep, "Sweep file");
  command->add_option("--views", given->views, "Viewpoints of the sweep, spread evenly")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command
      ->add_option("--row", given->row,
                   "Instead: the signatures with these row numbers, as query has them")
      ->delimiter(',')
      ->type_name("K");
  command->add_flag("--matrix", given->matrix,
                    "Built-in scenes: all combinations of night/day, band, surface, shape, "
                    "temperature, sea/land and range, and hard cases");
  command->add_flag("--small", given->small, "With --matrix: a few of them");
  command->add_flag("--each-effect", given->each_effect,
                    "With --matrix: one effect after the other is left out, wherever there is any "
                    "of it, and compared with its bound");
  command
      ->add_option("--relative-error", given->relative_error,
                   "Wanted of every in-band intensity (default: the sweep's; 0.01)")
      ->check(CLI::Range(1e-6, 1.0));
  command
      ->add_option("--reference-paths", given->reference,
                   "A reference with all effects and so many times the paths; 0: none")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  command->add_option("--timed", given->timed, "Runs of each, of which the fastest counts")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--values", given->values, "With --matrix: every value as CSV, to a file")
      ->type_name("FILE");
  command->callback([given, &exit_code] { exit_code = verify(*given); });
}

}  // namespace irsig
