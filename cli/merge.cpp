#include "schema/store/whole/merge.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "core/base/status_macros.h"
#include "jobs/check_resolved.h"
#include "jobs/keys/expand.h"
#include "planning/interruption.h"
#include "runner/job_runner.h"
#include "view/base/print.h"
#include "view/base/progress.h"

namespace irsig {
namespace {

absl::StatusOr<std::vector<schema::JobSpec>> jobs_of(const schema::ResolvedSweep& sweep,
                                                     int physics_version) {
  RETURN_IF_ERROR(check_resolved(sweep));
  return expand_jobs(sweep, physics_version);
}

absl::Status merge(const std::vector<std::string>& from, const std::string& to) {
  hear_interruptions();
  std::optional<LoopProgress> progress;
  std::uint64_t before = 0;
  const auto merged =
      merge_databases({from, jobs_of, physics_version()}, to,
                      [&](std::uint64_t rows, std::uint64_t of) -> absl::Status {
                        if (interrupted())
                          return absl::AbortedError("interrupted: nothing was written");
                        if (!progress) progress.emplace("rows merged", of);
                        progress->step(rows - before);
                        before = rows;
                        return absl::OkStatus();
                      });
  if (!merged.ok()) return merged.status();
  print_text("{}\n", merged->digest);
  for (const Merged::Sweep& sweep : merged->sweep) {
    print_note(
        "irsig: {}: {}: {} rows, {} of {} jobs done{}\n", to, sweep.name, sweep.rows, sweep.done,
        sweep.jobs,
        sweep.done < sweep.jobs ? " (irsig run SWEEP --db ... --resume goes on with it)" : "");
    if (sweep.left_behind > 0)
      print_note("irsig: note: {}: {} rows of an earlier version of the sweep stay behind\n",
                 sweep.name, sweep.left_behind);
  }
  return absl::OkStatus();
}

}  // namespace

void add_merge(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "merge",
      "Unite databases: shards of a sweep, unfinished runs of one, different sweeps; print the "
      "digest of the new one");
  const auto from = std::make_shared<std::vector<std::string>>();
  const auto to = std::make_shared<std::string>();
  command->add_option("DB", *from, "the databases; they stay as they are")->required();
  command->add_option("-o,--out", *to, "the new database")->required()->type_name("FILE");
  command->callback([from, to, &exit_code] { exit_code = report(merge(*from, *to)); });
  command->footer(
      "What two of them have done must be the same in both. What none has done waits:\n"
      "`irsig run SWEEP --db FILE --resume` computes it.");
}

}  // namespace irsig
