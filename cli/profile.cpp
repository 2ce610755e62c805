#include "view/report/profile.h"

#include <cstdio>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "core/base/status_macros.h"
#include "view/base/print.h"

namespace irsig {
namespace {

struct ProfileCommand {
  explicit ProfileCommand(CLI::App& command) : output(command, {"text", "csv", "json", "svg"}) {}
  OutputOptions output;
  std::string database;
  ProfileQuery query;
  std::vector<std::string> season;
  std::uint64_t row = 0;

  [[nodiscard]] absl::StatusOr<std::string> text(std::string_view format) const {
    ProfileQuery asked = query;
    if (row > 0) asked.row = row;
    asked.filter.season = NameSet(season);
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(database));
    ASSIGN_OR_RETURN(const auto rows, find_profiles(*reader, asked));
    std::set<std::string> sweeps;
    for (const StoredProfileRow& r : rows) sweeps.insert(r.sweep);
    for (const std::string& name : sweeps) {
      ASSIGN_OR_RETURN(const auto sweep, reader->sweep(name, SweepFiles::kNone));
      for (const std::string& note : profile_notes(rows, sweep.resolved.sweep()))
        print_note("irsig: note: {}\n", note);
    }
    ASSIGN_OR_RETURN(const auto published, reader->published(asked.filter.sweep));
    if (format == "svg") return plot_profile(rows, published);
    if (format == "text") return profile_summary(rows, published);
    std::ostringstream text;
    RETURN_IF_ERROR(write_profiles(rows, format, text));
    return text.str();
  }

  [[nodiscard]] absl::Status run() const {
    return output.write([&](std::string_view format, std::ostream& out) -> absl::Status {
      ASSIGN_OR_RETURN(const auto made, text(format));
      out << made << std::flush;
      return absl::OkStatus();
    });
  }
};

}  // namespace

void add_profile(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "profile",
      "Print the radiance profiles of a database: source radiance temperature against the number "
      "of reflections, beside published values. Also every row as CSV, or a picture.");
  const auto options = std::make_shared<ProfileCommand>(*command);
  command->add_option("DB", options->database, "Signature database (.sigdb)")->required();
  constexpr const char* kGroup = "Choose (all that match every option given)";
  const auto add = [&](const char* name, auto& value, const char* what, const char* type) {
    command->add_option(name, value, what)->group(kGroup)->type_name(type);
  };
  add("--profile-name", options->query.filter.profile, "Name of the profile", "NAME");
  add("--sweep", options->query.filter.sweep, "Name of the sweep", "NAME");
  add_seasons(*command, options->season)->group(kGroup);
  add("--band", options->query.filter.band, "Name of the band", "NAME");
  add("--row", options->row, "The one signature with this row number", "K");
  command->footer(
      "csv and json have every row, column and digit; svg draws the first profile along a line, "
      "or\n"
      "all points over reflections.");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
