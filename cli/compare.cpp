#include "view/report/compare.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "cli/target_extent.h"
#include "core/base/status_macros.h"
#include "view/base/print.h"

// irsig compare A [B]: the same signatures of two databases or of two conditions, side by side.
namespace irsig {
namespace {

// One side: its rows, and the bands that they are of.
struct Side {
  std::vector<QueryRow> rows;
  std::vector<schema::Band> bands;
};

absl::StatusOr<Side> side_of(const std::string& database, const Query& query) {
  ASSIGN_OR_RETURN(auto reader, StoreReader::open(database));
  Side out;
  ASSIGN_OR_RETURN(out.rows, run_query(*reader, query, stored_target_extent));
  if (out.rows.empty())
    return absl::NotFoundError(fmt::format("{}: no signature matches", database));
  std::string sweep, band;
  for (const QueryRow& row : out.rows) {
    const StoredSignature& s = row.signature;
    if (s.sweep == sweep && s.band == band) continue;
    sweep = s.sweep;
    band = s.band;
    ASSIGN_OR_RETURN(const auto stored, reader->sweep(sweep, SweepFiles::kNone));
    for (const schema::Band& b : stored.resolved.sweep().band())
      if (b.name() == band) out.bands.push_back(b);
  }
  for (const std::string& note : notes_on(out.rows)) print_note("irsig: note: {}\n", note);
  return out;
}

struct CompareCommand {
  explicit CompareCommand(CLI::App& command)
      : filter(command), output(command, {"text", "csv", "json"}) {}
  FilterOptions filter;
  OutputOptions output;
  std::string other, sweep, season, time, band;

  [[nodiscard]] absl::Status run() const {
    if (other.empty() && sweep.empty() && season.empty() && time.empty() && band.empty())
      return absl::InvalidArgumentError(
          "compare needs what to compare with: a second database, or --b-sweep, --b-season, "
          "--b-time or --b-band");
    ASSIGN_OR_RETURN(const Query a_query, filter.query());
    Query b_query = a_query;
    if (!season.empty()) b_query.season = season;
    for (const auto& [given, name] :
         {std::pair{&sweep, &b_query.sweep}, std::pair{&time, &b_query.time},
          std::pair{&band, &b_query.band}})
      if (!given->empty()) *name = *given;
    ASSIGN_OR_RETURN(const Side a, side_of(filter.database(), a_query));
    ASSIGN_OR_RETURN(const Side b, side_of(other.empty() ? filter.database() : other, b_query));
    const FreeNames free{!season.empty(), !time.empty(), !band.empty()};
    for (const schema::Band& of_a : a.bands)
      for (const schema::Band& of_b : b.bands)
        if (free.band || of_a.name() == of_b.name())
          if (const absl::Status same = check_same_band(of_a, of_b); !same.ok())
            return absl::InvalidArgumentError(same.message());  // of what the user chose
    ASSIGN_OR_RETURN(const RowComparison compared,
                     compare_rows(a.rows, b.rows, free, a_query.quantity));
    if (compared.only_in_a + compared.only_in_b > 0)
      print_note("irsig: note: {} rows of A and {} rows of B have no partner\n", compared.only_in_a,
                 compared.only_in_b);
    return output.write([&](std::string_view format, std::ostream& out) {
      return write_compared_rows(compared, columns_of(a_query.quantity), format, out);
    });
  }
};

}  // namespace

void add_compare(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "compare",
      "Print the same signatures of two databases, or of two conditions of one, side by "
      "side. Each line has both values, their ratio and difference, and whether the "
      "difference exceeds their combined error.");
  const auto options = std::make_shared<CompareCommand>(*command);
  command->add_option("B", options->other, "The second database; left out: the first one");
  constexpr const char* kGroup = "B, where it differs from A";
  for (const auto& [name, value, what] :
       {std::tuple{"--b-sweep", &options->sweep, "Name of B's sweep"},
        std::tuple{"--b-season", &options->season,
                   "Name of B's season; times are the same times of the day"},
        std::tuple{"--b-time", &options->time, "B's time, RFC 3339"},
        std::tuple{"--b-band", &options->band,
                   "Name of B's band, of the same limits and response"}})
    command->add_option(name, *value, what)->group(kGroup);
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
