#include <algorithm>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve.h"
#include "jobs/resolve_land.h"
#include "jobs/text/nearest_name.h"

namespace irsig {
namespace {

std::string element_path(const char* array, int i) { return absl::StrCat(array, "[", i, "]"); }

constexpr const char* kBackfaces = "accepted_backface_fraction";

// The file name without its folders.
std::string base_name(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

bool is_gltf(const schema::Model& model) {
  const std::string name = absl::AsciiStrToLower(model.file());
  return absl::EndsWith(name, ".gltf") || absl::EndsWith(name, ".glb");
}

// The glTF 2.0 standard states the unit and the axes of its files; other formats state none, and a
// sweep file does.
void set_stated_frame(schema::Model& model) {
  if (!is_gltf(model)) return;
  if (!model.has_unit_m()) model.set_unit_m(1);
  if (!model.has_forward_axis()) model.set_forward_axis("+z");
  if (!model.has_up_axis()) model.set_up_axis("+y");
}

void check_model_file(const schema::Model& model, std::string_view model_bytes,
                      schema::ResolvedSweep& resolved, const SectionCheck& check) {
  check.only(
      {"file", "unit_m", "forward_axis", "up_axis", "reference", "draft_m", "offset_m", kBackfaces},
      "to a model from a file");
  const std::string name = absl::AsciiStrToLower(base_name(model.file()));
  const auto ends = [&](const char* ending) { return absl::EndsWith(name, ending); };
  if (!(ends(".obj") || ends(".ply") || ends(".stl") || ends(".gltf") || ends(".glb"))) {
    check.error("file",
                absl::StrCat("= \"", model.file(),
                             "\" has an unknown ending, expected .obj, .ply, .stl, .gltf or .glb"));
  } else if (model_bytes.empty()) {
    check.error("file", absl::StrCat("= \"", model.file(), "\" is empty, expected a mesh"));
  }
  check.require(
      {"unit_m"},
      "expected the length of one unit of the file in metres (1, or 0.001 for millimetres)");
  check.require({"forward_axis", "up_axis"},
                "expected the file's axis, one of \"+x\", \"-x\", \"+y\", \"-y\", \"+z\", \"-z\"");
  const bool forward = check.one_of("forward_axis", {"+x", "-x", "+y", "-y", "+z", "-z"});
  const bool up = check.one_of("up_axis", {"+x", "-x", "+y", "-y", "+z", "-z"});
  if (forward && up && model.forward_axis()[1] == model.up_axis()[1]) {
    check.error("up_axis",
                absl::StrCat("= \"", model.up_axis(),
                             "\" is parallel to forward_axis, expected an axis at a right angle"));
  }
  (void)check.one_of("reference", {"origin", "bbox_center", "bbox_bottom_center"});
  resolved.set_model_sha256(sha256_hex(model_bytes));
  resolved.set_model_file_name(base_name(model.file()));
}

void check_generated_model(const schema::Model& model, const SectionCheck& check) {
  const std::string& kind = model.generate();
  if (!check.one_of("generate",
                    {"disk", "sphere", "box", "cylinder", "cone", "frigate", "cooling_tower"}))
    return;
  const std::string why = absl::StrCat("to a generated ", kind);
  if (kind == "disk" || kind == "sphere") {
    check.only({"generate", "triangles", "radius_m", "draft_m", "offset_m", kBackfaces}, why);
  } else if (kind == "cylinder" || kind == "cone") {
    check.only({"generate", "triangles", "radius_m", "length_m", "draft_m", "offset_m", kBackfaces},
               why);
  } else if (kind == "cooling_tower") {
    check.only({"generate", "triangles", "radius_m", "length_m", "width_m", "height_m", kBackfaces},
               why);
  } else {
    check.only({"generate", "triangles", "length_m", "width_m", "height_m", "draft_m", "offset_m",
                kBackfaces},
               why);
  }
  check.require({"triangles"}, "expected about how many triangles to make");
}

void check_model(std::string_view model_bytes, schema::ResolvedSweep& resolved,
                 Findings& findings) {
  if (!resolved.sweep().has_model()) {
    findings.add("model", "[model] is missing, expected file = \"...\" or generate = \"...\"");
    return;
  }
  const schema::Model& model = resolved.sweep().model();
  const SectionCheck check(model, "model", findings);
  if (model.has_file() == model.has_generate()) {
    findings.add("model", model.has_file()
                              ? "model has both file and generate, expected only one of them"
                              : "model has neither file nor generate, expected one of them");
  } else if (model.has_file()) {
    check_model_file(model, model_bytes, resolved, check);
  } else {
    check_generated_model(model, check);
  }
  if (model.offset_m_size() != 0 && model.offset_m_size() != 3)
    check.error("offset_m", absl::StrCat("has ", model.offset_m_size(),
                                         " numbers, expected three: forward, to starboard, up"));
}

// Every part has a temperature in every season: its own, or the season's.
void check_part_temperature(const schema::Part& part, const SectionCheck& check,
                            const schema::Sweep& sweep) {
  if (part.has_temperature_k() || (part.has_build_up() && sweep.has_heat())) return;
  std::vector<std::string> without, paths;
  for (int s = 0; s < sweep.season_size(); ++s) {
    const schema::Season& season = sweep.season(s);
    if (season.part_temperature_k().contains(part.name())) continue;
    if (season.has_temperature_field()) continue;
    without.push_back(season.name());
    paths.push_back(absl::StrCat("season[", s, "]"));
  }
  if (without.empty() && sweep.season_size() > 0) return;
  // Hours of one season share its name.
  const bool hours = std::set<std::string>(without.begin(), without.end()).size() < without.size();
  constexpr std::size_t kListed = 4;
  const std::size_t more = paths.size() - std::min(paths.size(), kListed);
  paths.resize(std::min(paths.size(), kListed));
  const std::string when = without.empty() ? ""
                           : !hours
                               ? absl::StrCat(" in season ", quoted_list(without))
                               : absl::StrCat(" in ", absl::StrJoin(paths, ", "),
                                              more > 0 ? absl::StrCat(" and ", more, " more") : "");
  check.error("temperature_k",
              absl::StrCat("is missing", when, ", expected temperature_k here or \"", part.name(),
                           "\" in part_temperature_k of every season, or temperature_field there",
                           sweep.has_heat() ? ", or build_up here: then it is computed" : ""));
}

// materials: the names that are known; library and built-in ones that parts name are added.
void check_parts(schema::Sweep& sweep, std::vector<std::string>& materials, Findings& findings) {
  if (sweep.part_size() == 0) {
    findings.add(
        "part",
        "[[part]] is missing, expected one or more parts with name, material and temperature_k");
    return;
  }
  const std::vector<std::string> names = check_names(sweep.part(), "part", findings);
  for (int i = 0; i < sweep.part_size(); ++i) {
    const schema::Part& part = sweep.part(i);
    const SectionCheck check(part, element_path("part", i), findings);
    check.require({"material"}, "expected the name of a material");
    if (part.has_material())
      resolve_part_material(part.material(), check, materials, sweep, findings);
    check_part_temperature(part, check, sweep);
    if (part.rest() && part.match_size() > 0)
      check.error("match", "does not apply to the part that takes the rest");
    for (int j = 0; j < part.match_size(); ++j) {
      if (!part.match(j).empty()) continue;
      const std::string path = absl::StrCat(element_path("part", i), ".match[", j, "]");
      findings.add(path,
                   path + " is empty, expected the name of a group of the model, with * and ?");
    }
  }
  for (int i = 0; i < sweep.season_size(); ++i) {
    for (const auto& [part, temperature_k] : sweep.season(i).part_temperature_k()) {
      const std::string path =
          absl::StrCat(element_path("season", i), ".part_temperature_k.", part);
      if (std::find(names.begin(), names.end(), part) == names.end()) {
        findings.add(path, absl::StrCat(path, ": there is no part \"", part, "\", ",
                                        suggestion(part, names)));
      }
    }
  }
}

}  // namespace

void resolve_target(std::string_view model_bytes, schema::ResolvedSweep& resolved,
                    Findings& findings) {
  if (resolved.sweep().has_model()) set_stated_frame(*resolved.mutable_sweep()->mutable_model());
  check_model(model_bytes, resolved, findings);
  schema::Sweep& sweep = *resolved.mutable_sweep();
  std::vector<std::string> materials = resolve_materials(sweep, findings);
  check_parts(sweep, materials, findings);
  resolve_land_materials(materials, sweep, findings);
}

}  // namespace irsig
