#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "jobs/expand.h"
#include "jobs/nearest_name.h"
#include "jobs/resolve.h"

namespace irsig {
namespace {

std::string element(const char* array, int i) { return absl::StrCat(array, "[", i, "]"); }

// The file name without its folders.
std::string base_name(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

void check_model_file(const schema::Model& model, std::string_view model_bytes,
                      schema::ResolvedSweep& resolved, const SectionCheck& check) {
  check.only({"file", "unit_m", "forward_axis", "up_axis", "reference"}, "to a model from a file");
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
  check.above("unit_m", 0);
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
  if (!check.one_of("generate", {"disk", "sphere", "box", "cylinder", "cone", "frigate"})) return;
  const std::string why = absl::StrCat("to a generated ", kind);
  if (kind == "disk" || kind == "sphere") {
    check.only({"generate", "triangles", "radius_m"}, why);
  } else if (kind == "cylinder" || kind == "cone") {
    check.only({"generate", "triangles", "radius_m", "length_m"}, why);
  } else {
    check.only({"generate", "triangles", "length_m", "width_m", "height_m"}, why);
  }
  check.require({"triangles"}, "expected about how many triangles to make");
  check.within("triangles", 1, 1e8);
  for (const char* name : {"radius_m", "length_m", "width_m", "height_m"}) check.above(name, 0);
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
}

// A table over wavelength: two points or more, increasing, and as wide as every band.
template <typename Points>
void check_table(const Points& points, const std::string& path, const schema::Sweep& sweep,
                 Findings& findings) {
  const std::size_t before = findings.count();
  if (points.size() < 2) {
    findings.add(path, absl::StrCat(path, " has one point, expected two or more"));
  }
  for (int i = 0; i < points.size(); ++i) {
    const std::string at = absl::StrCat(path, "[", i, "]");
    const SectionCheck check(points[i], at, findings);
    check.require({"lambda_um"}, "expected a wavelength in micrometres");
    check.above("lambda_um", 0);
    if (i > 0 && points[i].has_lambda_um() &&
        !(points[i].lambda_um() > points[i - 1].lambda_um())) {
      findings.add(
          at + ".lambda_um",
          absl::StrCat(at, ".lambda_um = ", points[i].lambda_um(),
                       " is not above the one before it, expected increasing wavelengths"));
    }
  }
  if (findings.count() != before) return;
  const double first = points[0].lambda_um(), last = points[points.size() - 1].lambda_um();
  for (const schema::Band& band : sweep.band()) {
    if (!band.has_lambda_min_um() || !band.has_lambda_max_um()) continue;
    if (first > band.lambda_min_um() || last < band.lambda_max_um()) {
      findings.add(path, absl::StrCat(path, " covers ", first, " to ", last,
                                      " um, expected all of the band \"", band.name(), "\", ",
                                      band.lambda_min_um(), " to ", band.lambda_max_um(), " um"));
    }
  }
}

void check_lambert(const schema::Material& material, const std::string& path,
                   const schema::Sweep& sweep, const SectionCheck& check, Findings& findings) {
  check.only({"name", "kind", "emissivity", "emissivity_table"}, "to kind \"lambert\"");
  if (check.at_most_one({"emissivity", "emissivity_table"}) == 0) {
    check.error("emissivity", "is missing, expected emissivity or emissivity_table");
  }
  check.within("emissivity", 0, 1);
  if (material.emissivity_table_size() == 0) return;
  check_table(material.emissivity_table(), path + ".emissivity_table", sweep, findings);
  for (int i = 0; i < material.emissivity_table_size(); ++i) {
    const SectionCheck point(material.emissivity_table(i),
                             absl::StrCat(path, ".emissivity_table[", i, "]"), findings);
    point.require({"value"}, "expected an emissivity");
    point.within("value", 0, 1);
  }
}

void check_cook_torrance(const schema::Material& material, const std::string& path,
                         const schema::Sweep& sweep, const SectionCheck& check,
                         Findings& findings) {
  check.only({"name", "kind", "n", "k", "optical_constants", "roughness", "fresnel", "masking",
              "normal_emissivity"},
             "to kind \"cook_torrance\"");
  if (material.optical_constants_size() > 0) {
    if (material.has_n() || material.has_k()) {
      check.error("optical_constants", "stands beside n or k, expected only one of the two forms");
    }
    check_table(material.optical_constants(), path + ".optical_constants", sweep, findings);
    for (int i = 0; i < material.optical_constants_size(); ++i) {
      const SectionCheck point(material.optical_constants(i),
                               absl::StrCat(path, ".optical_constants[", i, "]"), findings);
      point.require({"n", "k"}, "expected the optical constants n + i k");
      point.above("n", 0);
      point.within("k", 0, 1e6);
    }
  } else {
    check.require({"n", "k"},
                  "expected the optical constants n + i k (or a table, optical_constants)");
    check.above("n", 0);
    check.within("k", 0, 1e6);
  }
  check.require({"roughness"}, "expected the rms slope of the microfacets, 0.03 to 1");
  if (material.has_roughness() && material.roughness() >= 0 && material.roughness() < 0.03) {
    check.error(
        "roughness",
        absl::StrCat(
            "= ", material.roughness(),
            ", expected a number from 0.03 to 1 (near-mirror lobes are not supported yet)"));
  } else {
    check.within("roughness", 0.03, 1);
  }
  check.require({"fresnel"}, "expected \"exact\" or \"schlick\"");
  check.require({"masking"}, "expected \"v_groove\" or \"smith\"");
  (void)check.one_of("fresnel", {"exact", "schlick"});
  (void)check.one_of("masking", {"v_groove", "smith"});
  if (material.has_normal_emissivity() &&
      !(material.normal_emissivity() >= 0 && material.normal_emissivity() < 1)) {
    check.error("normal_emissivity", absl::StrCat("= ", material.normal_emissivity(),
                                                  ", expected a number from 0 to below 1"));
  }
}

const std::vector<std::string>& built_in_names() {
  static const std::vector<std::string> names = {"hull", "hull_index", "hull_paper"};
  return names;
}

bool is_built_in(const std::string& name) {
  return std::find(built_in_names().begin(), built_in_names().end(), name) !=
         built_in_names().end();
}

void check_material(const schema::Material& material, const std::string& path,
                    const schema::Sweep& sweep, Findings& findings) {
  const SectionCheck check(material, path, findings);
  check.require(
      {"kind"},
      "expected \"lambert\", \"cook_torrance\", \"hull\", \"hull_index\" or \"hull_paper\"");
  if (!check.one_of("kind", {"lambert", "cook_torrance", "hull", "hull_index", "hull_paper"}))
    return;
  const std::string& kind = material.kind();
  if (is_built_in(material.name()) && material.name() != kind) {
    check.error("name", absl::StrCat("\"", material.name(),
                                     "\" is built in with another meaning, expected another name"));
  }
  if (kind == "lambert") {
    check_lambert(material, path, sweep, check, findings);
  } else if (kind == "cook_torrance") {
    check_cook_torrance(material, path, sweep, check, findings);
  } else if (kind == "hull_paper") {
    check.only({"name", "kind", "allow_energy_gain"}, "to kind \"hull_paper\"");
    if (!material.allow_energy_gain()) {
      check.error("allow_energy_gain",
                  "is not true: hull_paper emits and reflects more than it receives, expected "
                  "allow_energy_gain = true "
                  "or kind = \"hull\"");
    }
  } else {
    check.only({"name", "kind"}, absl::StrCat("to kind \"", kind, "\""));
  }
}

std::vector<std::string> check_materials(const schema::Sweep& sweep, Findings& findings) {
  std::vector<std::string> names = check_names(sweep.material(), "material", findings);
  for (int i = 0; i < sweep.material_size(); ++i) {
    check_material(sweep.material(i), element("material", i), sweep, findings);
  }
  return names;
}

// A material that is built in can be named without being declared, except the one that needs a
// permission.
void check_part_material(const std::string& name, const SectionCheck& check,
                         std::vector<std::string>& known, schema::Sweep& sweep) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  if (name == "hull_paper") {
    check.error("material",
                "= \"hull_paper\" creates energy, expected a [[material]] of that kind with "
                "allow_energy_gain = true");
  } else if (is_built_in(name)) {
    schema::Material& material = *sweep.add_material();
    material.set_name(name);
    material.set_kind(name);
    known.push_back(name);
  } else {
    std::vector<std::string> all = known;
    for (const char* built_in : {"hull", "hull_index"}) {
      if (std::find(all.begin(), all.end(), built_in) == all.end()) all.emplace_back(built_in);
    }
    check.error("material",
                absl::StrCat("= \"", name, "\" is no known material: ", suggestion(name, all)));
  }
}

// Every part has a temperature in every season: its own, or the season's.
void check_part_temperature(const schema::Part& part, const SectionCheck& check,
                            const schema::Sweep& sweep) {
  if (part.has_temperature_k()) return;
  std::vector<std::string> without;
  for (const schema::Season& season : sweep.season()) {
    if (!season.part_temperature_k().contains(part.name())) without.push_back(season.name());
  }
  if (without.empty() && sweep.season_size() > 0) return;
  const std::string when = without.empty() ? "" : absl::StrCat(" in season ", quoted_list(without));
  check.error("temperature_k",
              absl::StrCat("is missing", when, ", expected temperature_k here or \"", part.name(),
                           "\" in part_temperature_k of every season"));
}

void check_parts(schema::Sweep& sweep, std::vector<std::string> materials, Findings& findings) {
  if (sweep.part_size() == 0) {
    findings.add(
        "part",
        "[[part]] is missing, expected one or more parts with name, material and temperature_k");
    return;
  }
  const std::vector<std::string> names = check_names(sweep.part(), "part", findings);
  for (int i = 0; i < sweep.part_size(); ++i) {
    const schema::Part& part = sweep.part(i);
    const SectionCheck check(part, element("part", i), findings);
    check.require({"material"}, "expected the name of a material");
    if (part.has_material()) check_part_material(part.material(), check, materials, sweep);
    check.within("temperature_k", 0, kHottestK);
    check_part_temperature(part, check, sweep);
    for (int j = 0; j < part.match_size(); ++j) {
      if (!part.match(j).empty()) continue;
      const std::string path = absl::StrCat(element("part", i), ".match[", j, "]");
      findings.add(path,
                   path + " is empty, expected the name of a group of the model, with * and ?");
    }
  }
  for (int i = 0; i < sweep.season_size(); ++i) {
    for (const auto& [part, temperature_k] : sweep.season(i).part_temperature_k()) {
      const std::string path = absl::StrCat(element("season", i), ".part_temperature_k.", part);
      if (std::find(names.begin(), names.end(), part) == names.end()) {
        findings.add(path, absl::StrCat(path, ": there is no part \"", part, "\", ",
                                        suggestion(part, names)));
      }
      if (!(temperature_k >= 0 && temperature_k <= kHottestK)) {
        findings.add(path, absl::StrCat(path, " = ", temperature_k,
                                        ", expected a number from 0 to ", kHottestK));
      }
    }
  }
}

}  // namespace

void resolve_target(std::string_view model_bytes, schema::ResolvedSweep& resolved,
                    Findings& findings) {
  check_model(model_bytes, resolved, findings);
  check_parts(*resolved.mutable_sweep(), check_materials(resolved.sweep(), findings), findings);
}

}  // namespace irsig
