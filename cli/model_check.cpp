#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "absl/strings/match.h"
#include "cli/check_heights.h"
#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/scene/check/mesh_lint.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/import/model_file.h"
#include "core/scene/mesh_measure.h"
#include "fmt/format.h"
#include "planning/model_frame.h"
#include "runner/model_warnings.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"
#include "view/base/table.h"

namespace irsig {
namespace {

// Facts about a model that are printed beside its faults.
struct ModelFacts {
  MeshMeasure measure;
  std::vector<std::string> group;
  std::vector<std::uint64_t> facets;  // of the groups
  double below_fraction = 0;          // of the area, below z = 0
  std::vector<PlacementNote> note;
};

ModelFacts facts_of(const Mesh& mesh, const Placement& placement) {
  ModelFacts facts{measure(mesh),
                   mesh.group,
                   {},
                   fraction_below_surface(mesh),
                   placement_notes(mesh, placement)};
  facts.facets.assign(mesh.group.size(), 0);
  for (const std::uint32_t g : mesh.triangle_group) ++facts.facets[g];
  return facts;
}

// Heights are up, mesh coordinates down.
struct Bound {
  const char* axis;
  double least, most;
};
std::vector<Bound> bounds_of(const MeshMeasure& m) {
  return {{"forward", m.box_min.x, m.box_max.x},
          {"starboard", m.box_min.y, m.box_max.y},
          {"height", 0.0 - m.box_max.z, 0.0 - m.box_min.z}};
}

std::string as_json(const ModelFacts& facts) {
  std::string out = fmt::format("\"area_m2\": {:.9g}, \"bounds_m\": {{", facts.measure.area_m2);
  for (const Bound& b : bounds_of(facts.measure))
    out += fmt::format("{}\"{}\": [{:.9g}, {:.9g}]", b.axis == std::string("forward") ? "" : ", ",
                       b.axis, b.least, b.most);
  out +=
      fmt::format("}}, \"below_waterline_fraction\": {:.6g}, \"groups\": [", facts.below_fraction);
  for (std::size_t g = 0; g < facts.group.size(); ++g)
    out += fmt::format("{}\n {{\"group\": {}, \"facets\": {}, \"area_m2\": {:.9g}}}",
                       g == 0 ? "" : ",", json_string(facts.group[g]), facts.facets[g],
                       facts.measure.group_area_m2[g]);
  out += "], \"notes\": [";
  for (const PlacementNote& note : facts.note)
    out +=
        fmt::format("{}\n {{\"key\": {}, \"text\": {}}}", &note == &facts.note.front() ? "" : ",",
                    json_string(note.key), json_string(note.text));
  return out + "]";
}

std::string as_text(const ModelFacts& facts) {
  std::string out;
  for (const Bound& b : bounds_of(facts.measure))
    out += fmt::format("{:<10}{:>12.6g} to {:<12.6g} m\n", b.axis, b.least, b.most);
  out += fmt::format("waterline  height 0: {:.3g} % of {:.6g} m2 lie below it\n",
                     100 * facts.below_fraction, facts.measure.area_m2);
  constexpr std::size_t kListed = 100;
  out += fmt::format("{} group{}\n", facts.group.size(), facts.group.size() == 1 ? "" : "s");
  for (std::size_t g = 0; g < std::min(kListed, facts.group.size()); ++g)
    out += fmt::format("          {}: {} facets, {:.6g} m2\n", one_line(facts.group[g]),
                       facts.facets[g], facts.measure.group_area_m2[g]);
  if (facts.group.size() > kListed)
    out += fmt::format("          and {} more\n", facts.group.size() - kListed);
  return out;
}

std::string frame_as_json(const MeshImport& how, const FrameSources& from) {
  return fmt::format(
      "\"frame\": {{\"unit_m\": {:.9g}, \"unit_from\": {}, \"forward_axis\": {}, "
      "\"forward_from\": {}, \"up_axis\": {}, \"up_from\": {}}}",
      how.unit_m, json_string(from.unit_m), json_string(how.forward_axis),
      json_string(from.forward_axis), json_string(how.up_axis), json_string(from.up_axis));
}

std::string frame_as_text(const MeshImport& how, const FrameSources& from) {
  return fmt::format(
      "frame     unit_m = {} ({}), forward_axis = \"{}\" ({}), up_axis = \"{}\" ({})\n", how.unit_m,
      from.unit_m, how.forward_axis, from.forward_axis, how.up_axis, from.up_axis);
}

std::string as_json(const std::string& file, const LintReport& report, const ModelFacts& facts,
                    const std::string& frame) {
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
  return out + "], " + frame + ", " + as_json(facts) + "}\n";
}

std::string as_text(const std::string& file, const LintReport& report, const ModelFacts& facts,
                    bool repairable, const std::string& frame) {
  std::string out =
      fmt::format("{}: {} facets, {} vertices, {} shells ({} closed), {:.6g} x {:.6g} x {:.6g} m\n",
                  file, report.facets, report.vertices, report.shells, report.closed_shells,
                  report.size_m.x, report.size_m.y, report.size_m.z);
  out += frame + as_text(facts);
  for (const LintFinding& f : report.finding) {
    out += fmt::format("{} {}: {}{}{}\n", f.is_error ? "error  " : "warning", fault_name(f.fault),
                       f.count, f.note.empty() ? "" : "  ", f.note);
    const bool vertex =
        f.fault == MeshFault::kUnusedVertex || f.fault == MeshFault::kDuplicateVertex;
    for (const LintFinding::Place& p : f.first)
      out += fmt::format("          {} {} at forward {:.6g}, starboard {:.6g}, height {:.6g}\n",
                         vertex ? "vertex" : "facet", p.number + 1, p.at.x, p.at.y, 0.0 - p.at.z);
  }
  if (report.finding.empty()) out += "nothing found\n";
  for (const PlacementNote& note : facts.note)
    out += fmt::format("sweep file: {}: {}\n", note.key, note.text);
  if (repairable)
    out += "proposed: --repair OUT.obj mends windings, duplicates and what has no area\n";
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
  explicit CheckCommand(CLI::App& command) : output(command, {"text", "json"}) {}
  OutputOptions output;
  MeshImport how;
  AskedFrame frame;
  LintOptions options;
  std::string repaired, surroundings = "sea";

  // The exit code, when nothing failed: 2 when the model has errors.
  [[nodiscard]] absl::StatusOr<int> run() {
    if (is_heights_file(how.file_name)) {
      if (!repaired.empty())
        return absl::InvalidArgumentError(
            "--repair: this is a map of heights, expected a model; state [land] fill_m for heights "
            "that are missing");
      return check_heights_file(how.file_name, output);
    }
    const absl::StatusOr<std::string> bytes = read_model_file(how.file_name, kMostModelBytes);
    if (!bytes.ok())
      return absl::InvalidArgumentError(
          fmt::format("{}: {}", how.file_name, std::string(bytes.status().message())));
    const FrameSources from = choose_frame(*bytes, frame, how);
    ASSIGN_OR_RETURN(const Mesh mesh, import_mesh(*bytes, how));
    LintReport found = lint(mesh, options);
    const Placement placement{how.unit_m, false, surroundings, false};
    ModelFacts facts = facts_of(mesh, placement);
    std::error_code none;
    if (!repaired.empty() && std::filesystem::equivalent(repaired, how.file_name, none))
      return absl::InvalidArgumentError(
          fmt::format("--repair {}: this is the model itself, expected another name", repaired));
    if (!repaired.empty() && !absl::EndsWithIgnoreCase(repaired, ".obj"))
      return absl::InvalidArgumentError(
          fmt::format("--repair {}: the copy is OBJ, expected a name that ends in .obj", repaired));
    const RepairedMesh result = repair(mesh);
    if (!repaired.empty()) {
      if (result.mesh.triangle.empty())
        return absl::InvalidArgumentError(how.file_name + ": no facet is left after repair");
      RETURN_IF_ERROR(replace_file(repaired, write_obj(result.mesh)));
      // Standard output belongs to the report on what was written.
      print_plain(stderr, as_text(result.log, repaired));
      found = lint(result.mesh, options);
      facts = facts_of(result.mesh, placement);
    }
    const bool repairable = repaired.empty() && result.log.did_something();
    const std::string& of = repaired.empty() ? how.file_name : repaired;
    const absl::Status written = output.write([&](std::string_view format, std::ostream& out) {
      out << (format == "json" ? as_json(of, found, facts, frame_as_json(how, from))
                               : as_text(of, found, facts, repairable, frame_as_text(how, from)))
          << std::flush;
      return absl::OkStatus();
    });
    if (!written.ok()) return written;
    return found.has_errors() ? 2 : 0;
  }
};

}  // namespace

void add_model_check(CLI::App& model, int& exit_code) {
  CLI::App* command = model.add_subcommand(
      "check",
      "Find what is wrong with a model file: holes, facets inside out, duplicates, needles, "
      "intersections, its unit. Of a map of heights it finds missing heights and spikes. "
      "Exit code 2: there are errors.");
  const auto options = std::make_shared<CheckCommand>(*command);
  command
      ->add_option("MODEL", options->how.file_name,
                   "OBJ, PLY, STL, glTF or GLB; HGT, ASC or GeoTIFF")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--unit-m", options->frame.unit_m,
                   "Metres in the file's unit (what the file states, or 1)")
      ->type_name("M");
  command
      ->add_option("--forward-axis", options->frame.forward_axis,
                   "The file's axis that points to the bow: +x, -x, ... -z (glTF: +z, others: +x)")
      ->type_name("AXIS");
  command
      ->add_option("--up-axis", options->frame.up_axis,
                   "The file's axis that points up (glTF: +y, others: +z)")
      ->type_name("AXIS");
  command
      ->add_option("--reference", options->how.reference,
                   "origin (default), bbox_center or bbox_bottom_center")
      ->type_name("NAME");
  command
      ->add_option("--surroundings", options->surroundings,
                   "What it is to stand on: sea (default), ground or none")
      ->check(CLI::IsMember({"sea", "ground", "none"}))
      ->type_name("KIND");
  command->add_option("--places", options->options.places, "Places to list of each fault (5)")
      ->type_name("N");
  command->add_flag("--open-surfaces", options->options.open_surfaces,
                    "Sheets are meant: open edges are no error");
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
