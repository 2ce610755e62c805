#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/output_options.h"
#include "cli/positive_number.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "core/scene/generate/generate_particles.h"

namespace irsig {
namespace {

struct ParticlesCommand {
  explicit ParticlesCommand(CLI::App& command) : output(command, {"obj"}) {
    output.out_option()->required();
  }
  OutputOptions output;
  ParticleBed bed;
  std::vector<double> diameter_m, fraction;
  std::string fractions_by = "number", shape = "irregular";

  [[nodiscard]] absl::Status run() {
    if (!fraction.empty() && fraction.size() != diameter_m.size())
      return absl::InvalidArgumentError("--fraction and --diameter-m have different lengths");
    if (fraction.empty() && diameter_m.size() > 1)
      return absl::InvalidArgumentError(
          "--fraction is missing: each diameter's share of the mix, by --fractions-by");
    bed.size.clear();
    for (std::size_t i = 0; i < diameter_m.size(); ++i)
      bed.size.push_back({diameter_m[i], fraction.empty() ? 1 : fraction[i]});
    bed.fractions_by_mass = fractions_by == "mass";
    bed.shape = shape == "sphere" ? GrainShape::kSphere : GrainShape::kIrregular;
    ASSIGN_OR_RETURN(const auto model, generate_particles(bed));
    RETURN_IF_ERROR(output.write(write_obj(model.mesh)));
    std::FILE* to = output.out() == "-" ? stderr : stdout;  // the model itself is there
    const ParticleReport& r = model.report;
    std::fprintf(to, "%s: %zu triangles; %llu grains in a cell of %g m, %u x %u cells\n",
                 one_line(output.out()).c_str(), model.mesh.triangle.size(),
                 static_cast<unsigned long long>(r.grains), bed.width_m, bed.tiles, bed.tiles);
    for (std::size_t i = 0; i < bed.size.size(); ++i)
      std::fprintf(to, "group grain_%gum  %llu grains in a cell\n", 1e6 * bed.size[i].diameter_m,
                   static_cast<unsigned long long>(r.grains_of_size[i]));
    std::fprintf(to, "coverage %.4f  packing_fraction %.4f  largest_overlap %.2g of a radius\n",
                 r.coverage, r.packing_fraction, r.largest_overlap);
    std::fprintf(to, "upper surface: mean_height_m %.6g  rms_height_m %.6g  top_m %.6g\n",
                 r.mean_height_m, r.rms_height_m, r.top_m);
    return absl::OkStatus();
  }
};

}  // namespace

void add_model_particles(CLI::App& model, int& exit_code) {
  CLI::App* command = model.add_subcommand(
      "particles", "Grains dropped on a plate: settled, of a stated mix of sizes");
  const auto options = std::make_shared<ParticlesCommand>(*command);
  command->add_option("--diameter-m", options->diameter_m, "Grain sizes, separated by commas")
      ->required()
      ->delimiter(',')
      ->type_name("M,M...");
  command->add_option("--fraction", options->fraction, "Their shares of the mix")
      ->delimiter(',')
      ->type_name("X,X...");
  command->add_option("--fractions-by", options->fractions_by, "mass or number (default)")
      ->check(CLI::IsMember({"mass", "number"}));
  command->add_option("--width-m", options->bed.width_m, "Width of the square cell that is filled")
      ->required()
      ->type_name("M");
  command->add_option("--tiles", options->bed.tiles, "Copies of the cell in each direction")
      ->type_name("N");
  auto* coverage = command->add_option("--coverage", options->bed.coverage,
                                       "Part of the plate to be hidden, up to 0.99");
  auto* layers = command->add_option("--layers", options->bed.layers,
                                     "Grain cross-sections for each unit of plate");
  coverage->excludes(layers)->check(CLI::Range(1e-6, 0.99))->type_name("X");
  layers->check(CLI::Range(1e-6, 50.0))->type_name("X");
  auto* amount = command->add_option_group("amount");
  amount->add_options(coverage, layers);
  amount->require_option(1);
  command->add_option("--shape", options->shape, "irregular (default) or sphere")
      ->check(CLI::IsMember({"irregular", "sphere"}));
  command->add_option("--irregularity", options->bed.irregularity,
                      "How much an irregular grain's radius varies (default 0.2)");
  command->add_option("--subdivisions", options->bed.subdivisions,
                      "Of an icosahedron: 0 to 3 are 20, 80 (default), 320, 1280 triangles");
  command->add_option("--seed", options->bed.seed, "Default 0")
      ->check(seed_number())
      ->type_name("N");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
