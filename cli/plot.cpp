#include "view/plot.h"

#include <memory>
#include <optional>
#include <string>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"

namespace irsig {
namespace {

struct PlotCommand {
  explicit PlotCommand(CLI::App& command) : filter(command), output(command, {"svg"}) {
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
    if (const auto format = output.format(); !format.ok()) return format.status();
    auto query = filter.query();
    if (!query.ok()) return query.status();
    auto reader = StoreReader::open(filter.database());
    if (!reader.ok()) return reader.status();
    auto svg = kind == "polar"           ? plot_polar(**reader, *query, elevation_deg)
               : kind == "spectrum"      ? plot_spectrum(**reader, *query)
               : kind == "transmittance" ? plot_transmittance(**reader, *query)
                                         : plot_map(**reader, *query);
    if (!svg.ok()) return svg.status();
    return output.write(*svg);
  }
};

}  // namespace

void add_plot(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "plot",
      "Draw signatures as SVG: polar (in-band values against aspect azimuth), spectrum (of one "
      "viewpoint) or map (in-band values over all aspects), of the source intensity or of "
      "--quantity; or transmittance (of the air, from one viewpoint)");
  const auto options = std::make_shared<PlotCommand>(*command);
  command->add_option("--kind", options->kind, "polar, spectrum, map or transmittance")
      ->required()
      ->type_name("KIND")
      ->check(CLI::IsMember({"polar", "spectrum", "map", "transmittance"}));
  command
      ->add_option("--elevation", options->elevation_deg,
                   "Elevation of a polar plot [deg]; default: the lowest that the viewpoints cover")
      ->type_name("DEG");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
