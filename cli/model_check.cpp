#include <cstdio>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "core/base/user_file.h"
#include "core/scene/mesh_lint.h"
#include "fmt/format.h"
#include "view/atomic_file.h"
#include "view/print.h"
#include "view/table.h"

namespace irsig {
namespace {

std::string as_json(const std::string& file, const LintReport& report) {
  std::string out = fmt::format(
      "{{\"file\": {}, \"facets\": {}, \"vertices\": {}, \"shells\": {}, \"closed_shells\": {}, "
      "\"size_m\": [{:.9g}, {:.9g}, {:.9g}], \"errors\": {}, \"findings\": [",
      json_string(file), report.facets, report.vertices, report.shells, report.closed_shells,
      report.size_m.x, report.size_m.y, report.size_m.z, report.has_errors());
  for (const LintFinding& f : report.finding) {
    out += fmt::format(
        "{}\n {{\"fault\": \"{}\", \"severity\": \"{}\", \"count\": {}, \"note\": {}, \"first\": [",
        &f == &report.finding.front() ? "" : ",", fault_name(f.fault),
        f.is_error ? "error" : "warning", f.count, json_string(f.note));
    for (const LintFinding::Place& p : f.first)
      out += fmt::format("{}{{\"number\": {}, \"at_m\": [{:.9g}, {:.9g}, {:.9g}]}}",
                         &p == &f.first.front() ? "" : ", ", p.number + 1, p.at.x, p.at.y, p.at.z);
    out += "]}";
  }
  out += "], \"open_groups\": [";
  for (const OpenGroup& g : report.open_group)
    out +=
        fmt::format("{}{{\"group\": {}, \"facets\": {}}}",
                    &g == &report.open_group.front() ? "" : ", ", json_string(g.group), g.facets);
  return out + "]}\n";
}

std::string as_text(const std::string& file, const LintReport& report) {
  std::string out =
      fmt::format("{}: {} facets, {} vertices, {} shells ({} closed), {:.6g} x {:.6g} x {:.6g} m\n",
                  file, report.facets, report.vertices, report.shells, report.closed_shells,
                  report.size_m.x, report.size_m.y, report.size_m.z);
  for (const LintFinding& f : report.finding) {
    out += fmt::format("{} {}: {}{}{}\n", f.is_error ? "error  " : "warning", fault_name(f.fault),
                       f.count, f.note.empty() ? "" : "  ", f.note);
    const bool vertex =
        f.fault == MeshFault::kUnusedVertex || f.fault == MeshFault::kDuplicateVertex;
    for (const LintFinding::Place& p : f.first)
      out += fmt::format("          {} {} at {:.6g} {:.6g} {:.6g}\n", vertex ? "vertex" : "facet",
                         p.number + 1, p.at.x, p.at.y, p.at.z);
  }
  if (report.finding.empty()) out += "nothing found\n";
  if (report.open_group.empty()) return out;
  out +=
      "proposed in the sweep file, if these are sheets and not bodies with holes: two_sided = true "
      "for the parts of\n";
  for (const OpenGroup& g : report.open_group)
    out += fmt::format(
        "          group {}: {} facets of open shells, which send nothing from "
        "behind\n",
        g.group, g.facets);
  return out;
}

std::string as_text(const RepairLog& log, const std::string& file) {
  std::string out = "repaired:";
  const std::size_t bare = out.size();
  const auto say = [&](std::uint64_t count, const char* what) {
    if (count > 0) out += fmt::format(" {} {};", count, what);
  };
  say(log.merged_vertices, "vertices merged");
  say(log.dropped_zero_area, "facets without area dropped");
  say(log.dropped_duplicates, "duplicate facets dropped");
  say(log.dropped_vertices, "unused vertices dropped");
  say(log.turned_facets, "facets turned");
  say(log.unorientable_edges, "edges left across which no orientation agrees");
  if (out.size() == bare) out += " there was nothing to do;";
  return out + " written to " + file + "\n";
}

struct CheckCommand {
  MeshImport how;
  LintOptions options;
  bool json = false;
  std::string repaired;

  // The exit code, when nothing failed: 2 when the model has errors.
  [[nodiscard]] absl::StatusOr<int> run() const {
    const absl::StatusOr<std::string> bytes = read_user_file(how.file_name, kMostModelBytes);
    if (!bytes.ok())
      return absl::InvalidArgumentError(
          fmt::format("{}: {}", how.file_name, std::string(bytes.status().message())));
    const absl::StatusOr<Mesh> mesh = import_mesh(*bytes, how);
    if (!mesh.ok()) return mesh.status();
    LintReport found = lint(*mesh, options);
    if (!repaired.empty()) {
      const RepairedMesh result = repair(*mesh);
      if (result.mesh.triangle.empty())
        return absl::InvalidArgumentError(how.file_name + ": no facet is left after repair");
      if (const absl::Status status = replace_file(repaired, write_obj(result.mesh)); !status.ok())
        return status;
      // Standard output belongs to the report on what was written.
      print_plain(stderr, as_text(result.log, repaired));
      found = lint(result.mesh, options);
    }
    const std::string& of = repaired.empty() ? how.file_name : repaired;
    print_plain(stdout, json ? as_json(of, found) : as_text(of, found));
    return found.has_errors() ? 2 : 0;
  }
};

}  // namespace

void add_model_check(CLI::App& model, int& exit_code) {
  CLI::App* command = model.add_subcommand(
      "check",
      "What is wrong with a model file: holes, facets inside out, duplicates, needles, "
      "intersections, its unit. Exit code 2 when there are errors");
  const auto options = std::make_shared<CheckCommand>();
  command->add_option("file", options->how.file_name, "OBJ, PLY, STL, glTF or GLB")
      ->required()
      ->type_name("FILE");
  command->add_option("--unit-m", options->how.unit_m, "Metres in the file's unit")->type_name("M");
  command->add_option("--forward-axis", options->how.forward_axis, "+x (default), -x, ... -z")
      ->type_name("AXIS");
  command->add_option("--up-axis", options->how.up_axis, "+z (default), ...")->type_name("AXIS");
  command
      ->add_option("--reference", options->how.reference,
                   "origin (default), bbox_center or bbox_bottom_center")
      ->type_name("NAME");
  command->add_option("--places", options->options.places, "Places to list of each fault (5)")
      ->type_name("N");
  command->add_flag("--open-surfaces", options->options.open_surfaces,
                    "Sheets are meant: open edges are no error");
  command->add_flag("--json", options->json, "The report as JSON");
  command
      ->add_option("--repair", options->repaired,
                   "Write a repaired copy as OBJ (metres, body axes) and report on that")
      ->type_name("OUT.obj");
  command->callback([options, &exit_code] {
    const absl::StatusOr<int> code = options->run();
    exit_code = code.ok() ? *code : report(code.status());
  });
}

}  // namespace irsig
