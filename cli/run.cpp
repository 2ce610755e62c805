#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <set>
#include <thread>

#include "cli/accuracy_options.h"
#include "cli/commands.h"
#include "cli/loading.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/local_farm.h"
#include "coordinator/client/progress_text.h"
#include "core/base/status_macros.h"
#include "core/scene/trace/tracer.h"
#include "fmt/format.h"
#include "jobs/keys/expand.h"
#include "planning/interruption.h"
#include "planning/load_sweep.h"
#include "planning/machine.h"
#include "planning/prediction.h"
#include "planning/time_budget.h"
#include "schema/shard.h"
#include "view/base/print.h"
#include "view/base/progress.h"
#include "view/report/outcome.h"
#include "view/report/profile.h"

namespace irsig {
namespace {

using Steady = std::chrono::steady_clock;

struct RunAsked {
  std::string sweep_path, db_path;
  std::uint32_t workers = 0;
  AccuracyAsked accuracy;
  bool resume = false;
  bool replace = false;
  bool plan = false;
  std::string launcher = "local";
  SlurmPlan slurm;
  std::string isa;  // empty: each worker its machine's widest

  [[nodiscard]] bool on_cluster() const { return launcher == "slurm"; }
};

constexpr double kMuchMemory = 1e9;  // is said before it is taken

// False, and said: what is stored of the sweep's files is damaged. Submitted again, they replace
// it.
absl::StatusOr<bool> has_its_files(const RunAsked& asked, const std::string& sweep) {
  ASSIGN_OR_RETURN(const auto reader, StoreReader::open(asked.db_path));
  const auto stored = reader->sweep(sweep);
  if (!absl::IsDataLoss(stored.status()))
    return stored.ok() ? true : absl::StatusOr<bool>(stored.status());
  print_note("irsig: {}: a file of the sweep \"{}\" is damaged there, and is stored again\n",
             asked.db_path, sweep);
  return false;
}

// Compares the sweep with an existing database. Returns true if the database is complete, false if
// jobs are left, or an error that the user has to resolve. A sweep that was created from a time
// budget is taken over with its samples.
absl::StatusOr<bool> is_complete_already(const LocalFarm& farm, const RunAsked& asked,
                                         LoadedSweep& loaded) {
  ASSIGN_OR_RETURN(const auto known, farm_status(farm.address()));
  for (const auto& sweep : known.sweep()) {
    const bool same_name = sweep.name() == loaded.resolved.sweep().name();
    if (same_name && has_time_budget(loaded.resolved)) {
      ASSIGN_OR_RETURN(const auto reader, StoreReader::open(asked.db_path));
      ASSIGN_OR_RETURN(const auto kept, reader->sweep(sweep.name(), SweepFiles::kNone));
      if (kept.resolved.slice_size() > 0)
        return absl::InvalidArgumentError(fmt::format(
            "{} holds a slice of the sweep \"{}\": its rows have the samples that a time budget "
            "once became; expected accuracy.samples_per_replicate = {} instead of time_budget_s",
            asked.db_path, sweep.name(), kept.resolved.sweep().accuracy().samples_per_replicate()));
      ASSIGN_OR_RETURN(auto stored, stored_sweep(farm.address(), sweep.sweep_sha256()));
      if (is_same_but_for_samples(stored, loaded.resolved)) loaded.resolved = std::move(stored);
    }
    const bool same =
        same_name && sweep.sweep_sha256() == sha256_hex(canonical_encoding(loaded.resolved));
    if (same && sweep.done() == sweep.jobs()) return has_its_files(asked, sweep.name());
    const bool open = settled_jobs(sweep) < sweep.jobs() || (same && sweep.done() < sweep.jobs());
    if (open && (same || !same_name) && !asked.resume) {
      return absl::InvalidArgumentError(fmt::format(
          "{} holds the sweep \"{}\" with {} of {} jobs done: add --resume to go on with it",
          asked.db_path, sweep.name(), sweep.done(), sweep.jobs()));
    }
  }
  return false;
}

absl::StatusOr<std::unique_ptr<LocalFarm>> start_farm(const RunAsked& asked) {
  return LocalFarm::start(
      {.db_path = asked.db_path,
       .workers = asked.workers,
       .coordinator_executable = beside_this_executable("irsig-coordinator"),
       .worker_executable = beside_this_executable("irsig-worker"),
       .worker_arguments = asked.isa.empty() ? std::vector<std::string>()
                                             : std::vector<std::string>{"--isa", asked.isa},
       .slurm = asked.on_cluster() ? std::optional(asked.slurm) : std::nullopt});
}

// The database is one plain file, or complete with a journal beside it, and the user told so.
absl::Status end(LocalFarm& farm) {
  auto ended = farm.stop();
  if (!farm.warning().empty()) print_note("irsig: warning: {}\n", farm.warning());
  return ended;
}

absl::Status stopped(const RunAsked& asked, const std::string& why) {
  return absl::AbortedError(
      fmt::format("{}; what is done is in {}: run the same command with --resume to go on", why,
                  asked.db_path));
}

// Watches until every job is settled; the last status.
absl::StatusOr<schema::StatusReply> watch(LocalFarm& farm, const RunAsked& asked,
                                          const std::string& sweep_sha256) {
  ProgressLine line;
  SweepWatch sweep_watch;
  std::uint64_t jobs_settled = 0;
  auto pause = std::chrono::milliseconds(20);
  while (true) {
    if (interrupted()) {
      (void)end(farm);
      return stopped(asked, "interrupted");
    }
    const auto status = farm_status(farm.address(), 5);
    bool open = true;
    if (status.ok()) {
      open = false;
      jobs_settled = 0;
      for (const auto& sweep : status->sweep()) {
        jobs_settled += settled_jobs(sweep);
        open = open || settled_jobs(sweep) < sweep.jobs();
        if (sweep.sweep_sha256() != sweep_sha256) continue;
        line.show(sweep_watch.text(
            sweep, asked.workers,
            std::chrono::duration<double>(Steady::now().time_since_epoch()).count()));
      }
    }
    if (!open) return *status;
    if (auto alive = farm.keep_alive(jobs_settled); !alive.ok()) {
      return stopped(asked, std::string(alive.message()));
    }
    // Small sweeps end within a second: look often at first.
    std::this_thread::sleep_for(pause);
    pause = std::min(std::chrono::milliseconds(500), pause * 5 / 4);
  }
}

// Returns in brackets the requested accuracy that the sweep did not reach. Prints a warning if a
// part of the target was seen from behind.
absl::StatusOr<std::string> shortfall(StoreReader& reader, const std::string& sweep) {
  ASSIGN_OR_RETURN(const auto outcome, reader.outcome(sweep));
  ASSIGN_OR_RETURN(const auto stored, reader.sweep(sweep, SweepFiles::kNone));
  if (const std::string text = backface_text(outcome); !text.empty())
    print_note("irsig: warning: {}: {}\n", sweep, text);
  const std::string text = stopped_text(outcome, stored.resolved.sweep().accuracy());
  return text.empty() ? "" : " (" + text + ")";
}

// Returns the limits that kept rows from the requested accuracy. Rows are read only if some of them
// did not reach it.
absl::StatusOr<std::vector<std::string>> limits_of(StoreReader& reader, const std::string& sweep) {
  ASSIGN_OR_RETURN(const auto outcome, reader.outcome(sweep));
  ASSIGN_OR_RETURN(const auto stored, reader.sweep(sweep, SweepFiles::kNone));
  std::vector<std::string> out;
  for (const auto& [reason, count] : outcome.stop)
    if (reason == "accuracy_not_reached" || reason == "sample_limit") {
      ASSIGN_OR_RETURN(out, limit_notes(reader, sweep));
      break;
    }
  if (std::string text = image_text(outcome, stored.resolved.sweep().image()); !text.empty())
    out.push_back(std::move(text));
  return out;
}

absl::Status summarize(const schema::StatusReply& status, const RunAsked& asked, double seconds) {
  ASSIGN_OR_RETURN(auto reader, StoreReader::open(asked.db_path));
  for (const std::string& warning : status.warning()) print_note("irsig: warning: {}\n", warning);
  absl::Status failed;
  for (const auto& sweep : status.sweep()) {
    ASSIGN_OR_RETURN(const auto heat, reader->heat_jobs(sweep.name()));
    std::set<std::string> said;
    for (const StoredHeatJob& job : heat)
      if (!job.warning.empty() && said.insert(job.warning).second)
        print_note("irsig: warning: {}, {}: {}\n", sweep.name(), job.season, job.warning);
    ASSIGN_OR_RETURN(const auto kept, shortfall(*reader, sweep.name()));
    const std::string stages =
        sweep.heat_jobs() == 0
            ? std::string()
            : fmt::format(" (temperatures: {} of {})", sweep.heat_done(), sweep.heat_jobs());
    print_text("{}: {} of {} jobs done{}, {}, worst error {:.2g} %{}, {:.1f} s -> {}\n",
               sweep.name(), sweep.done(), sweep.jobs(), stages,
               count_text(static_cast<double>(sweep.rays()), "rays"),
               100 * sweep.worst_relative_error(), kept, seconds, asked.db_path);
    ASSIGN_OR_RETURN(const auto limits, limits_of(*reader, sweep.name()));
    for (const std::string& note : limits) print_note("irsig: note: {}\n", note);
    if (sweep.done() == sweep.jobs()) continue;
    std::string text = fmt::format("{}: {} jobs failed, {} were cancelled", sweep.name(),
                                   sweep.quarantined(), sweep.cancelled());
    for (const auto& failure : sweep.failure()) text += "\n  " + failure;
    failed = absl::AbortedError(text);
  }
  return failed;
}

// The sweep's profiles beside what is published.
absl::Status print_profiles(const schema::ResolvedSweep& sweep, const std::string& db_path) {
  if (sweep.sweep().profile().empty()) return absl::OkStatus();
  ASSIGN_OR_RETURN(auto reader, StoreReader::open(db_path));
  const std::string& name = sweep.sweep().name();
  ASSIGN_OR_RETURN(const auto rows,
                   reader->profiles({.sweep = name, .season = "", .band = "", .profile = ""}));
  ASSIGN_OR_RETURN(const auto published, reader->published(name));
  print_text("\n{}", profile_summary(rows, published));
  for (const std::string& note : profile_notes(rows, sweep.sweep()))
    print_note("irsig: note: {}\n", note);
  return absl::OkStatus();
}

// How many stored rows of the sweep are of another version of it, which go as soon as new ones
// come: that is the user's to decide.
absl::Status check_what_is_replaced(const RunAsked& asked, const schema::ResolvedSweep& sweep) {
  ASSIGN_OR_RETURN(auto reader, StoreReader::open(asked.db_path));
  const std::string& name = sweep.sweep().name();
  ASSIGN_OR_RETURN(const auto rows, reader->rows_of_jobs(name));
  if (rows.empty()) return absl::OkStatus();
  if (sweep.has_shard()) {
    ASSIGN_OR_RETURN(const auto stored, reader->sweep(name, SweepFiles::kNone));
    RETURN_IF_ERROR(check_may_replace(stored.resolved, sweep));
  }
  std::set<std::string> keys;
  for (const schema::JobSpec& job : expand_jobs(sweep, physics_version()))
    keys.insert(job.job_key());
  std::uint64_t stored = 0, replaced = 0;
  for (const auto& [key, count] : rows) {
    stored += count;
    if (!keys.contains(key)) replaced += count;
  }
  if (replaced == 0) return absl::OkStatus();
  const std::string changed = fmt::format("the sweep \"{}\" has changed: {} of its {} stored rows ",
                                          name, replaced, stored);
  if (!asked.replace)
    return absl::InvalidArgumentError(
        absl::StrCat(asked.db_path, ": ", changed,
                     "would be replaced: add --replace if they may go, or give another --db, or "
                     "the sweep another name"));
  print_note("irsig: {}will be replaced\n", changed);
  return absl::OkStatus();
}

absl::Status check_launcher(const RunAsked& asked) {
  const SlurmPlan& s = asked.slurm;
  if (!asked.on_cluster()) {
    if (s.nodes > 0 || !s.partition.empty() || !s.time_limit.empty() || !s.options.empty() ||
        !s.host.empty())
      return absl::InvalidArgumentError(
          "--nodes, --partition, --time-limit, --slurm-option and --host belong to --launcher "
          "slurm");
    return absl::OkStatus();
  }
  if ((asked.workers > 0) == (s.nodes > 0))
    return absl::InvalidArgumentError(
        "--launcher slurm: expected --workers N (one by one, a CPU each) or --nodes N (whole "
        "nodes, "
        "a worker on each CPU)");
  return absl::OkStatus();
}

// More workers than jobs would only wait in Slurm's queue, and end.
void limit_slurm(const schema::ResolvedSweep& sweep, RunAsked& asked) {
  if (!asked.on_cluster()) return;
  asked.slurm.say = [](const std::string& what) { print_note("irsig: note: {}\n", what); };
  const double jobs = job_count(sweep) + sweep.heat_size();
  for (auto& [count, what] : {std::pair<std::uint32_t*, const char*>{&asked.workers, "workers"},
                              {&asked.slurm.nodes, "nodes"}}) {
    if (*count <= jobs) continue;
    print_note("irsig: note: {} jobs: {} {} are asked for in place of {}\n", jobs, jobs, what,
               *count);
    *count = static_cast<std::uint32_t>(jobs);
  }
}

absl::Status run_sweep(RunAsked asked) {
  const auto start = Steady::now();
  ASSIGN_OR_RETURN(auto loaded, load_shown(asked.sweep_path, asked.accuracy));
  for (const std::string& line : loaded.warnings) print_note("{}\n", line);
  RETURN_IF_ERROR(check_launcher(asked));
  if (!asked.isa.empty() && !asked.on_cluster()) {
    RETURN_IF_ERROR(pin_isa(asked.isa));
  }
  limit_slurm(loaded.resolved, asked);
  if (asked.workers == 0) asked.workers = asked.on_cluster() ? asked.slurm.nodes : usable_cores();
  print_note("irsig: {}\n", size_text(loaded.size));
  const std::uint64_t conditions = loaded.size.conditions;
  // A shortage of memory is no error on a cluster: Slurm knows the memory of its nodes, and
  // --slurm-option --mem-per-cpu=... requests it.
  if (auto fits = check_memory(loaded.memory, conditions, asked.on_cluster() ? 1 : asked.workers,
                               usable_memory_bytes());
      !fits.ok() && !asked.on_cluster())
    return fits;
  if (loaded.memory.bytes(conditions, asked.workers) > kMuchMemory)
    print_note("irsig: memory: {}\n", memory_text(loaded.memory, conditions, asked.workers));
  std::error_code unknown;  // then opening says why
  if (asked.resume && !std::filesystem::exists(asked.db_path, unknown) && !unknown) {
    return absl::InvalidArgumentError(asked.db_path + ": there is no such database to resume");
  }
  // First of all the right to write the database: of two runs at once the second one is refused
  // now, not after its pilot. A database that the coordinator made and nothing was submitted to is
  // removed by the coordinator itself.
  ASSIGN_OR_RETURN(const auto started, start_farm(asked));
  LocalFarm& farm = *started;
  ASSIGN_OR_RETURN(const auto complete, is_complete_already(farm, asked, loaded));
  if (complete) {
    RETURN_IF_ERROR(end(farm));
    const std::string& name = loaded.resolved.sweep().name();
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(asked.db_path));
    ASSIGN_OR_RETURN(const auto kept, shortfall(*reader, name));
    print_text("{}: complete already, nothing to compute{} -> {}\n", name, kept, asked.db_path);
    if (asked.plan)
      print_note("irsig: note: --plan predicts what is to compute: nothing is predicted here\n");
    return print_profiles(loaded.resolved, asked.db_path);
  }
  if (has_time_budget(loaded.resolved)) {
    ASSIGN_OR_RETURN(const auto spent, spend_shown(loaded, asked.workers));
    print_note("irsig: {}\n", spent);
  }
  std::optional<schema::Prediction> prediction;
  if (asked.plan) {
    ASSIGN_OR_RETURN(const auto pilot, pilot_sweep(loaded));
    const StoredPrediction predicted = prediction_of(pilot, loaded.resolved, asked.workers);
    print_note("irsig: {}\n", prediction_line(predicted));
    prediction = as_message(predicted);
  }
  RETURN_IF_ERROR(check_what_is_replaced(asked, loaded.resolved));
  hear_interruptions();
  ASSIGN_OR_RETURN(const auto reply, submit(farm.address(), loaded.resolved, loaded.assets,
                                            static_cast<std::uint32_t>(physics_version()),
                                            prediction ? &*prediction : nullptr));
  if (reply.jobs_to_compute() < reply.jobs()) {
    print_note("irsig: {} of {} jobs to compute\n", reply.jobs_to_compute(), reply.jobs());
  }
  RETURN_IF_ERROR(farm.start_workers());
  ASSIGN_OR_RETURN(const auto status, watch(farm, asked, reply.sweep_sha256()));
  RETURN_IF_ERROR(end(farm));
  const absl::Status summarized =
      summarize(status, asked, std::chrono::duration<double>(Steady::now() - start).count());
  RETURN_IF_ERROR(print_profiles(loaded.resolved, asked.db_path));
  return summarized;
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("run", "compute a sweep on this machine into a database");
  auto asked = std::make_shared<RunAsked>();
  command->add_option("SWEEP", asked->sweep_path, "the sweep file")->required();
  command->add_option("--db", asked->db_path, "the database; made if it does not exist")
      ->required();
  add_accuracy_options(*command, asked->accuracy, asked->workers);
  add_shard_option(*command, asked->accuracy);
  command->add_flag("--plan", asked->plan,
                    "predict the time first and store the prediction for `irsig report`");
  command->add_flag("--resume", asked->resume, "go on with what the database holds unfinished");
  command->add_flag("--replace", asked->replace,
                    "rows of an earlier version of this sweep may be replaced");
  command
      ->add_option("--launcher", asked->launcher,
                   "where workers run: on this machine (local), or as a job array of Slurm")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  command->add_option("--nodes", asked->slurm.nodes, "slurm: whole nodes, a worker on each CPU")
      ->check(CLI::Range(1, 10000));
  command->add_option("--partition", asked->slurm.partition, "slurm: as sbatch has it");
  command->add_option("--time-limit", asked->slurm.time_limit,
                      "slurm: time limit of the workers; those that it ends are handed in again");
  command
      ->add_option("--slurm-option", asked->slurm.options,
                   "slurm: any other option of sbatch, as --slurm-option=--mem-per-cpu=2G; may be "
                   "repeated")
      ->type_name("OPTION");
  command->add_option("--host", asked->slurm.host,
                      "slurm: the name under which the nodes reach this machine (default: its "
                      "host name)");
  command
      ->add_option("--isa", asked->isa,
                   "no wider instruction set than this one: of nodes that are not alike, the one "
                   "that all of them have")
      ->check(CLI::IsMember({"avx512", "avx2", "sse4.2"}));
  command->callback([=, &exit_code] { exit_code = report(run_sweep(*asked)); });
  command->footer(
      "Ctrl-C stops it with exit code 1; the database stays consistent, and --resume goes on.");
}

}  // namespace irsig
