#include "view/export.h"

#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/filter_options.h"

namespace irsig {
namespace {

struct ExportCommand {
  explicit ExportCommand(CLI::App& command) : filter(command) {}
  FilterOptions filter;
  std::string format, out;

  [[nodiscard]] absl::Status run() const {
    auto query = filter.query();
    if (!query.ok()) return query.status();
    auto reader = StoreReader::open(filter.database());
    if (!reader.ok()) return reader.status();
    return export_file(**reader, *query, format, out);
  }
};

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "export",
      "Write signatures to a file: csv (one line each) or netcdf (netCDF-4 with CF "
      "attributes: scalars, causes, parts and spectra)");
  const auto options = std::make_shared<ExportCommand>(*command);
  command->add_option("--format", options->format, "csv or netcdf")
      ->required()
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"csv", "netcdf"}));
  command->add_option("--out", options->out, "File to write, replaced when complete")
      ->required()
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
