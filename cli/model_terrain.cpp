#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/output_options.h"
#include "cli/positive_number.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "core/land/generate_terrain.h"
#include "view/base/print.h"

namespace irsig {
namespace {

struct TerrainCommand {
  explicit TerrainCommand(CLI::App& command) : output(command, {"asc"}) {
    output.out_option()->required();
  }
  OutputOptions output;
  Terrain terrain;
  std::string layer = "heights";

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(const HeightRaster raster, generate_terrain(terrain, layer));
    RETURN_IF_ERROR(output.write(write_asc(raster)));
    const auto [lowest, highest] =
        std::minmax_element(raster.height_m.begin(), raster.height_m.end());
    double sum = 0;
    for (const float value : raster.height_m) sum += value;
    std::FILE* to = output.out() == "-" ? stderr : stdout;  // the grid itself is there
    print_plain(to, fmt::format("{}: {} of {} x {} samples, {:.6g} to {:.6g}, mean {:.6g}\n",
                                one_line(output.out()), layer, raster.columns, raster.rows, *lowest,
                                *highest, sum / double(raster.height_m.size())));
    return absl::OkStatus();
  }
};

}  // namespace

void add_model_terrain(CLI::App& model, int& exit_code) {
  CLI::App* command = model.add_subcommand(
      "terrain",
      "Hills, a river, a road and fields: heights or material fractions as an ESRI ASCII grid");
  const auto options = std::make_shared<TerrainCommand>(*command);
  command
      ->add_option("--map-layer", options->layer,
                   "What is written: heights (default), or the fraction of a material: asphalt, "
                   "bare_soil, grass, "
                   "water, wheat")
      ->check(
          CLI::IsMember(std::vector<std::string>(terrain_layers().begin(), terrain_layers().end())))
      ->type_name("NAME");
  command->add_option("--seed", options->terrain.seed, "Default 0")
      ->check(seed_number())
      ->type_name("N");
  command
      ->add_option("--width-m", options->terrain.width_m, "Width of the square map (default 10000)")
      ->type_name("M");
  command->add_option("--spacing-m", options->terrain.spacing_m, "Of samples (default 30)")
      ->type_name("M");
  command
      ->add_option("--relief-m", options->terrain.relief_m,
                   "Height of the highest hills above their valleys (default 200)")
      ->type_name("M");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
