#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "core/base/printable.h"
#include "core/scene/mesh.h"
#include "core/scene/mesh_measure.h"
#include "view/atomic_file.h"

namespace irsig {
namespace {

struct ModelCommand {
  MeshGenerator what;
  std::string out;

  [[nodiscard]] absl::Status run() const {
    const absl::StatusOr<Mesh> mesh = generate_mesh(what);
    if (!mesh.ok()) return mesh.status();
    const absl::Status status = replace_file(out, write_obj(*mesh));
    if (!status.ok()) return status;
    print(*mesh);
    return absl::OkStatus();
  }

 private:
  void print(const Mesh& mesh) const {
    const MeshMeasure m = measure(mesh);
    std::printf("%s: %zu triangles, %zu vertices, %llu open edges\n", one_line(out).c_str(),
                mesh.triangle.size(), mesh.vertex.size(),
                static_cast<unsigned long long>(m.open_edges));
    std::printf("area_m2 %.9g  volume_m3 %.9g\n", m.area_m2, m.volume_m3);
    std::printf("x forward %.6g to %.6g m, y starboard %.6g to %.6g m, z down %.6g to %.6g m\n",
                m.box_min.x, m.box_max.x, m.box_min.y, m.box_max.y, m.box_min.z, m.box_max.z);
    for (std::size_t i = 0; i < mesh.group.size(); ++i)
      std::printf("group %-16s area_m2 %.6g\n", one_line(mesh.group[i]).c_str(),
                  m.group_area_m2[i]);
  }
};

}  // namespace

void add_model(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "model", "Write a parametric model as Wavefront OBJ (x forward, y port, z up, metres)");
  const auto options = std::make_shared<ModelCommand>();
  // Required unless a subcommand is named: checked when it is known that none was.
  const std::vector<CLI::Option*> required = {
      command
          ->add_option("kind", options->what.kind,
                       "disk, sphere, box, cylinder, cone, frigate or cooling_tower")
          ->type_name("KIND"),
      command->add_option("--triangles", options->what.triangles, "About how many triangles")
          ->type_name("N"),
      command->add_option("--out", options->out, "File to write, replaced when complete")
          ->type_name("FILE")};
  // What is not given is the generator's default, so that a 0 must not pass for it.
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
            "disk, sphere, cylinder, cone; cooling_tower: its throat");
  dimension("--length-m", options->what.length_m,
            "box, cylinder, cone, frigate; cooling_tower: its casing");
  dimension("--width-m", options->what.width_m, "box, frigate, cooling_tower");
  dimension("--height-m", options->what.height_m,
            "box; frigate: its freeboard; cooling_tower: of its deck");
  add_model_particles(*command, exit_code);
  add_model_check(*command, exit_code);
  command->callback([options, required, command, &exit_code] {
    if (!command->get_subcommands().empty()) return;
    for (const CLI::Option* option : required)
      if (option->count() == 0) throw CLI::RequiredError(option->get_name());
    exit_code = report(options->run());
  });
}

}  // namespace irsig
