#include "view/profile.h"

#include <cstdio>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>

#include "cli/commands.h"
#include "view/atomic_file.h"
#include "view/print.h"

namespace irsig {
namespace {

struct ProfileCommand {
  std::string database, format, out;
  bool csv = false, svg = false;
  ProfileQuery query;
  std::uint64_t row = 0;

  [[nodiscard]] absl::StatusOr<std::string> text() const {
    ProfileQuery asked = query;
    if (row > 0) asked.row = row;
    auto reader = StoreReader::open(database);
    if (!reader.ok()) return reader.status();
    const auto rows = find_profiles(**reader, asked);
    if (!rows.ok()) return rows.status();
    const auto published = (*reader)->published(asked.filter.sweep);
    if (!published.ok()) return published.status();
    if (svg) return plot_profile(*rows, *published);
    if (!csv && format.empty()) return profile_summary(*rows, *published);
    std::ostringstream text;
    if (auto status = write_profiles(*rows, csv ? "csv" : format, text); !status.ok())
      return status;
    return text.str();
  }

  [[nodiscard]] absl::Status run() const {
    const auto made = text();
    if (!made.ok()) return made.status();
    if (!out.empty()) return replace_file(out, *made);
    data_output() << *made;
    return absl::OkStatus();
  }
};

}  // namespace

void add_profile(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "profile",
      "Print the radiance profiles of a database: apparent temperature against the number of "
      "reflections, beside what is published; or every row as CSV, or a picture");
  const auto options = std::make_shared<ProfileCommand>();
  command->add_option("DB", options->database, "Signature database (.sigdb)")->required();
  constexpr const char* kGroup = "Choose (all that match every option given)";
  const auto add = [&](const char* name, auto& value, const char* what, const char* type) {
    command->add_option(name, value, what)->group(kGroup)->type_name(type);
  };
  add("--profile", options->query.filter.profile, "Name of the profile", "NAME");
  add("--sweep", options->query.filter.sweep, "Name of the sweep", "NAME");
  add("--season", options->query.filter.season, "Name of the season", "NAME");
  add("--band", options->query.filter.band, "Name of the band", "NAME");
  add("--row", options->row, "Row number of the viewpoint's signature", "K");
  CLI::Option* csv =
      command->add_flag("--csv", options->csv, "Every row, every column, every digit");
  CLI::Option* svg = command->add_flag(
      "--svg", options->svg,
      "A picture of the first profile along a line, or of all points over reflections");
  csv->excludes(svg);
  command->add_option("--format", options->format, "Every row as table (for people), csv or json")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"table", "csv", "json"}))
      ->excludes(csv)
      ->excludes(svg);
  command->add_option("--out", options->out, "File to write instead, replaced when complete")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
