#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "schema/store/reader.h"
#include "view/report/temperatures.h"

namespace irsig {
namespace {

struct TemperaturesAsked {
  explicit TemperaturesAsked(CLI::App& command) : output(command, {"text", "csv", "json"}) {
    command.add_option("DB", database, "Signature database (.sigdb)")->required();
    command.add_option("--sweep", filter.sweep, "Name of the sweep")->type_name("NAME");
    add_seasons(command, season);
    command
        .add_option("--time", filter.time_utc,
                    "Time, RFC 3339 with any offset: 2025-12-21T10:30:00+09:00")
        ->type_name("TIME");
  }
  OutputOptions output;
  std::string database;
  std::vector<std::string> season;
  TemperatureFilter filter;

  [[nodiscard]] absl::Status run() const {
    TemperatureFilter wanted = filter;
    wanted.season = NameSet(season);
    if (!wanted.time_utc.empty()) {
      ASSIGN_OR_RETURN(const auto time, parse_rfc3339(wanted.time_utc));
      wanted.time_utc = format_rfc3339_utc(time);
    }
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(database));
    return output.write([&](std::string_view format, std::ostream& out) {
      return write_temperatures(*reader, wanted, format, out);
    });
  }
};

}  // namespace

void add_show_temperatures(CLI::App& show, int& exit_code) {
  auto* command = show.add_subcommand(
      "temperatures",
      "What a database's jobs have computed of each part's facets: mean, coldest, hottest, error, "
      "by season and time");
  const auto asked = std::make_shared<TemperaturesAsked>(*command);
  command->callback([asked, &exit_code] { exit_code = report(asked->run()); });
  command->footer("`irsig export --temperatures` writes those of every facet.");
}

}  // namespace irsig
