#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_join.h"
#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/scene/mesh.h"
#include "core/scene/mesh_measure.h"
#include "view/base/print.h"

namespace irsig {
namespace {

struct ModelCommand {
  explicit ModelCommand(CLI::App& command) : output(command, {"obj"}) {}
  MeshGenerator what;
  OutputOptions output;

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(const Mesh mesh, generate_mesh(what));
    RETURN_IF_ERROR(output.write(write_obj(mesh)));
    print(mesh);
    return absl::OkStatus();
  }

 private:
  void print(const Mesh& mesh) const {
    const MeshMeasure m = measure(mesh);
    std::FILE* to = output.out() == "-" ? stderr : stdout;  // the model itself is there
    print_plain(
        to, fmt::format("{}: {} triangles, {} vertices, {} open edges\n", one_line(output.out()),
                        mesh.triangle.size(), mesh.vertex.size(), m.open_edges));
    print_plain(to, fmt::format("area_m2 {:.9g}  volume_m3 {:.9g}\n", m.area_m2, m.volume_m3));
    print_plain(to, fmt::format("x forward {:.6g} to {:.6g} m, y starboard {:.6g} to {:.6g} m, "
                                "z down {:.6g} to {:.6g} m\n",
                                m.box_min.x, m.box_max.x, m.box_min.y, m.box_max.y, m.box_min.z,
                                m.box_max.z));
    for (std::size_t i = 0; i < mesh.group.size(); ++i)
      print_plain(to, fmt::format("group {:<16} area_m2 {:.6g}\n", one_line(mesh.group[i]),
                                  m.group_area_m2[i]));
  }
};

}  // namespace

void add_model(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "model", "Write a parametric model as Wavefront OBJ (x forward, y port, z up, metres)");
  const auto options = std::make_shared<ModelCommand>(*command);
  // Required unless a subcommand is named: checked when it is known that none was.
  const std::vector<CLI::Option*> required = {
      command->add_option("KIND", options->what.kind, absl::StrJoin(generator_kinds(), ", "))
          ->type_name("NAME")
          ->check([](const std::string& kind) -> std::string {
            const std::vector<std::string> known = generator_kinds();
            if (std::find(known.begin(), known.end(), kind) != known.end()) return "";
            return "model \"" + kind + "\", expected one of " + absl::StrJoin(known, ", ") +
                   "; or a command, particles, plume, terrain or check";
          }),
      command->add_option("--triangles", options->what.triangles, "About how many triangles")
          ->type_name("N"),
      options->output.out_option()};
  // A dimension that is not given keeps the generator's default, so that 0 must be refused: it
  // would stand for "not given".
  const auto positive = [](const std::string& text) -> std::string {
    double value = 0;
    return CLI::detail::lexical_cast(text, value) && value > 0
               ? ""
               : "\"" + text + "\", expected a positive number of metres";
  };
  const auto dimension = [&](const char* name, double& value, const char* of) {
    command->add_option(name, value, of)->type_name("M")->check(positive);
  };
  dimension("--radius-m", options->what.radius_m,
            "Radius of a disk, sphere, cylinder or cone; cooling_tower: of its throat");
  dimension("--length-m", options->what.length_m,
            "Length of a box, cylinder, cone or frigate; cooling_tower: of its casing");
  dimension("--width-m", options->what.width_m, "Width of a box, frigate or cooling_tower");
  dimension("--height-m", options->what.height_m,
            "Height of a box; frigate: its freeboard; cooling_tower: of its deck");
  add_model_particles(*command, exit_code);
  add_model_check(*command, exit_code);
  add_model_plume(*command, exit_code);
  add_model_terrain(*command, exit_code);
  command->callback([options, required, command, &exit_code] {
    if (!command->get_subcommands().empty()) return;
    for (const CLI::Option* option : required)
      if (option->count() == 0) throw CLI::RequiredError(option->get_name());
    exit_code = report(options->run());
  });
}

}  // namespace irsig
