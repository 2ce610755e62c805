#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "view/query_table.h"
#include "view/thumbnail.h"

namespace irsig {
namespace {

struct QueryCommand {
  explicit QueryCommand(CLI::App& command) : filter(command) {}
  FilterOptions filter;
  QueryContent content;
  std::string format = "table", thumbnail;

  [[nodiscard]] absl::Status run() const {
    auto query = filter.query();
    if (!query.ok()) return query.status();
    auto reader = StoreReader::open(filter.database());
    if (!reader.ok()) return reader.status();
    auto rows = run_query(**reader, *query);
    if (!rows.ok()) return rows.status();
    if (!thumbnail.empty()) return write_thumbnail(**reader, *rows, thumbnail);
    if (rows->empty()) std::fputs("irsig: no signature matches\n", stderr);
    return write_rows(**reader, *rows, content, format, std::cout);
  }
};

}  // namespace

void add_query(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "query",
      "Print signatures: in-band intensity [W/sr] with its standard error, projected area [m2] and "
      "apparent temperature [K], per season, time, band and viewpoint");
  const auto options = std::make_shared<QueryCommand>(*command);
  command->add_flag("--spectrum", options->content.spectrum,
                    "One line per wavelength: spectral intensity [W/(sr um)]");
  CLI::Option* parts = command->add_flag("--parts", options->content.parts,
                                         "One line per part of the target: its in-band intensity");
  parts->excludes("--spectrum");
  command->add_flag("--causes", options->content.causes,
                    "Split by cause: emitted; sun, sky, sea and other parts reflected");
  command
      ->add_option("--thumbnail", options->thumbnail,
                   "Write the image of the one signature chosen (.png for people, .exr: float32 "
                   "in-band radiance) instead of printing it")
      ->type_name("FILE");
  command
      ->add_option("--format", options->format,
                   "table (for people), csv or json (every column, every digit)")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"table", "csv", "json"}))
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
