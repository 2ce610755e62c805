#include "view/export.h"

#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "planning/export_temperatures.h"
#include "view/print.h"

namespace irsig {
namespace {

struct ExportCommand {
  explicit ExportCommand(CLI::App& command)
      : filter(command), output(command, {"csv", "netcdf", "envi", "temperatures"}) {
    output.out_option()->required();
  }
  FilterOptions filter;
  OutputOptions output;

  [[nodiscard]] absl::Status run() const {
    auto query = filter.query();
    if (!query.ok()) return query.status();
    auto reader = StoreReader::open(filter.database());
    if (!reader.ok()) return reader.status();
    const auto format = output.format();
    if (!format.ok()) return format.status();
    if (*format == "temperatures")
      return output.write([&](std::string_view, std::ostream& out) {
        return export_temperatures(filter.database(), query->sweep, query->season, query->time,
                                   out);
      });
    if (output.out() != "-") return export_file(**reader, *query, *format, output.out());
    if (*format != "csv")
      return absl::InvalidArgumentError(
          absl::StrCat("--out -: ", *format, " needs a file, only csv can be streamed"));
    return export_csv(**reader, *query, data_output());
  }
};

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "export",
      "Write signatures to a file: csv (one line each) or netcdf (netCDF-4 with CF "
      "attributes: scalars, causes, parts and spectra) or envi (spectral library of one --band, "
      "with its .hdr); or, as csv, the temperatures of all facets");
  const auto options = std::make_shared<ExportCommand>(*command);
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
