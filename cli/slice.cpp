#include "schema/store/whole/slice.h"

#include <memory>
#include <optional>
#include <string>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "core/base/status_macros.h"
#include "planning/interruption.h"
#include "view/base/print.h"
#include "view/base/progress.h"

namespace irsig {
namespace {

struct SliceCommand {
  explicit SliceCommand(CLI::App& command) : filter(command) {}
  FilterOptions filter;
  std::string out;
  bool source_digest = false;

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(const auto query, filter.query());
    if (query.interpolate)
      return absl::InvalidArgumentError(
          "--interpolate: a slice holds computed signatures only; expected --nearest or --within");
    ASSIGN_OR_RETURN(const auto asked, filter_of(query));
    if (asked.season.names().size() > 1) {
      ASSIGN_OR_RETURN(const auto reader, StoreReader::open(filter.database()));
      RETURN_IF_ERROR(check_seasons(*reader, asked.season));
    }
    hear_interruptions();
    std::optional<LoopProgress> progress;
    std::uint64_t before = 0;
    const auto sliced =
        slice_database(filter.database(), {asked, filter.text(), source_digest}, out,
                       [&](std::uint64_t rows, std::uint64_t of) -> absl::Status {
                         if (interrupted())
                           return absl::AbortedError("interrupted: nothing was written");
                         if (!progress) progress.emplace("rows copied", of);
                         progress->step(rows - before);
                         before = rows;
                         return absl::OkStatus();
                       });
    if (absl::IsNotFound(sliced.status())) {
      ASSIGN_OR_RETURN(const auto reader, StoreReader::open(filter.database()));
      RETURN_IF_ERROR(explain_nothing(*reader, asked));
    }
    if (!sliced.ok()) return sliced.status();
    if (!sliced->source_digest.empty()) print_text("of {}\n", sliced->source_digest);
    print_text("{}\n", sliced->digest);
    print_note("irsig: {}: {} of {} rows\n", out, sliced->rows, sliced->source_rows);
    return absl::OkStatus();
  }
};

}  // namespace

void add_slice(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "slice",
      "Write the chosen signatures, with all that is stored of them, into a database of their own; "
      "print its digest");
  const auto options = std::make_shared<SliceCommand>(*command);
  command->add_option("-o,--out", options->out, "The new database")->required()->type_name("FILE");
  command->add_flag("--source-digest", options->source_digest,
                    "Keep the digest of DB, too, and print it first; reads all of it");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
