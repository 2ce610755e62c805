#include "view/plot.h"

#include <memory>
#include <optional>
#include <string>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "view/hours.h"

namespace irsig {
namespace {

struct PlotCommand {
  explicit PlotCommand(CLI::App& command)
      : filter(command), output(command, {"svg", "csv", "json"}) {
    output.out_option()->required();
  }
  FilterOptions filter;
  OutputOptions output;
  std::string kind;
  std::optional<double> elevation_deg;

  [[nodiscard]] absl::Status run() const {
    if (elevation_deg && kind != "polar") {
      return absl::InvalidArgumentError("--elevation belongs to --kind polar");
    }
    const auto format = output.format();
    if (!format.ok()) return format.status();
    if (*format != "svg" && kind != "hours")
      return absl::InvalidArgumentError("--kind " + kind +
                                        " is drawn as svg alone; `irsig query` and `irsig export` "
                                        "write its numbers");
    auto query = filter.query();
    if (!query.ok()) return query.status();
    auto reader = StoreReader::open(filter.database());
    if (!reader.ok()) return reader.status();
    if (kind == "hours") return write_hours_as(*format, **reader, *query);
    auto svg = kind == "polar"           ? plot_polar(**reader, *query, elevation_deg)
               : kind == "spectrum"      ? plot_spectrum(**reader, *query)
               : kind == "transmittance" ? plot_transmittance(**reader, *query)
                                         : plot_map(**reader, *query);
    if (!svg.ok()) return svg.status();
    return output.write(*svg);
  }

 private:
  [[nodiscard]] absl::Status write_hours_as(const std::string& format, StoreReader& reader,
                                            const Query& query) const {
    const auto hours = hours_of(reader, query);
    if (!hours.ok()) return hours.status();
    if (format == "svg") return output.write(plot_hours(*hours));
    return output.write(
        [&](std::string_view table, std::ostream& out) { return write_hours(*hours, table, out); });
  }
};

}  // namespace

void add_plot(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "plot",
      "Draw signatures as SVG: polar (in-band values against aspect azimuth), spectrum (of one "
      "viewpoint), map (in-band values over all aspects) or hours (in-band values of one viewpoint "
      "against the time of day, and the temperatures that were computed for them; also csv and "
      "json), of the source intensity or of --quantity; or transmittance (of the air, from one "
      "viewpoint)");
  const auto options = std::make_shared<PlotCommand>(*command);
  command->add_option("--kind", options->kind, "polar, spectrum, map, hours or transmittance")
      ->required()
      ->type_name("KIND")
      ->check(CLI::IsMember({"polar", "spectrum", "map", "hours", "transmittance"}));
  command
      ->add_option("--elevation", options->elevation_deg,
                   "Elevation of a polar plot [deg]; default: the lowest that the viewpoints cover")
      ->type_name("DEG");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
