#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/materials/optical/material_library.h"
#include "jobs/files/library_material.h"
#include "jobs/files/material_kinds.h"
#include "jobs/files/sweep_materials.h"
#include "jobs/resolve.h"
#include "jobs/resolve_land.h"
#include "jobs/text/nearest_name.h"
#include "jobs/text/number_bounds.h"

namespace irsig {
namespace {

// Keys of every kind of material, for computed temperatures.
constexpr SectionCheck::Names::value_type kAbsorptance = "solar_absorptance",
                                          kEmissivity = "thermal_emissivity";

const std::vector<std::string>& built_in_names() {
  static const std::vector<std::string> names = {"hull", "hull_index", "hull_paper"};
  return names;
}

bool is_built_in(const std::string& name) {
  return std::find(built_in_names().begin(), built_in_names().end(), name) !=
         built_in_names().end();
}

// Adds an error at `path` for each band that a table over wavelength does not cover.
void check_covers(double first_um, double last_um, const std::string& path,
                  const std::string& subject, const schema::Sweep& sweep, Findings& findings) {
  for (const schema::Band& band : sweep.band()) {
    if (!band.has_lambda_min_um() || !band.has_lambda_max_um()) continue;
    if (first_um > band.lambda_min_um() || last_um < band.lambda_max_um()) {
      findings.add(path, absl::StrCat(subject, " covers ", first_um, " to ", last_um,
                                      " um, expected all of the band \"", band.name(), "\", ",
                                      band.lambda_min_um(), " to ", band.lambda_max_um(), " um"));
    }
  }
}

// A table over wavelength: two points or more, increasing, and as wide as every band.
template <typename Points>
void check_table(const Points& points, const std::string& path, const schema::Sweep& sweep,
                 Findings& findings) {
  if (points.size() < 2) {
    findings.add(path, absl::StrCat(path, " has one point, expected two or more"));
  }
  for (int i = 0; i < points.size(); ++i) {
    const std::string at = absl::StrCat(path, "[", i, "]");
    const SectionCheck check(points[i], at, findings);
    check.require({"lambda_um"}, "expected a wavelength in micrometres");
    if (i > 0 && points[i].has_lambda_um() &&
        !(points[i].lambda_um() > points[i - 1].lambda_um())) {
      findings.add(
          at + ".lambda_um",
          absl::StrCat(at, ".lambda_um = ", points[i].lambda_um(),
                       " is not above the one before it, expected increasing wavelengths"));
    }
  }
  if (findings.any_at(path)) return;
  check_covers(points[0].lambda_um(), points[points.size() - 1].lambda_um(), path, path, sweep,
               findings);
}

// One [[material]]: what its checks share.
class MaterialCheck {
 public:
  MaterialCheck(const schema::Material& material, std::string path, const schema::Sweep& sweep,
                Findings& findings)
      : material_(material),
        path_(std::move(path)),
        sweep_(sweep),
        findings_(findings),
        check_(material, path_, findings) {}

  void stated(const MaterialKind& kind) const {
    check_.only(keys_of(kind), absl::StrCat("to kind \"", kind.name, "\""));
    if (std::string(kind.name) == "lambert") {
      lambert(kind);
    } else {
      for (const OpticalProperty& property : kind.property) this->property(property);
    }
    for (const char* key : kind.required) check_.require({key}, meaning_of(key));
    (void)check_.one_of("fresnel", {"exact", "schlick"});
    (void)check_.one_of("masking", {"v_groove", "smith"});
    for (const char* form : {"published", "printed"}) creates_energy(form);
  }

  void hull() const {
    const std::string& kind = material_.kind();
    if (kind != "hull_paper") {
      check_.only({"name", "kind", kAbsorptance, kEmissivity},
                  absl::StrCat("to kind \"", kind, "\""));
      return;
    }
    check_.only({"name", "kind", kAbsorptance, kEmissivity, "allow_energy_gain"},
                "to kind \"hull_paper\"");
    if (!material_.allow_energy_gain()) {
      check_.error("allow_energy_gain",
                   "is not true: hull_paper emits and reflects more than it receives, expected "
                   "allow_energy_gain = true "
                   "or kind = \"hull\"");
    }
  }

  // The library's entry in the place of the table that names it; nothing if that was wrong.
  [[nodiscard]] std::optional<schema::Material> from_library() const {
    const std::size_t before = findings_.count();
    check_.only({"name", "kind", kAbsorptance, kEmissivity, "entry", "roughness"},
                "to kind \"library\"");
    const char* key = material_.has_entry() ? "entry" : "name";
    const std::string name = material_.has_entry() ? material_.entry() : material_.name();
    const auto entry = library_entry(name);
    if (!entry.ok()) {
      std::vector<std::string> known;
      for (const LibraryEntry& e : material_library()) known.push_back(e.spec.name);
      if (!name.empty())
        check_.error(key, absl::StrCat("= \"", name, "\" is no material of the library: ",
                                       suggestion(name, known)));
      return std::nullopt;
    }
    auto message = message_of(entry->spec);
    if (!message.ok()) {
      check_.error(key, std::string(message.status().message()));
      return std::nullopt;
    }
    if (material_.has_roughness() && !message->has_roughness()) {
      check_.error("roughness", absl::StrCat("does not apply to the library's \"", name,
                                             "\", which is a ", message->kind()));
    }
    covers(entry->spec, key);
    if (findings_.count() != before) return std::nullopt;
    message->set_name(material_.name());
    message->set_entry(name);
    if (material_.has_roughness()) message->set_roughness(material_.roughness());
    if (material_.has_solar_absorptance())
      message->set_solar_absorptance(material_.solar_absorptance());
    else if (const auto absorbed = solar_absorptance(entry->spec); absorbed && sweep_.has_heat())
      message->set_solar_absorptance(*absorbed);
    if (material_.has_thermal_emissivity())
      message->set_thermal_emissivity(material_.thermal_emissivity());
    return *message;
  }

  void covers(const MaterialSpec& entry, const char* key) const {
    const WavelengthRange range = wavelength_range(entry);
    if (range.everywhere) return;
    check_covers(range.min_um, range.max_um, check_.path(key),
                 absl::StrCat(check_.path(key), ": the library's \"", entry.name, "\""), sweep_,
                 findings_);
  }

 private:
  static std::string meaning_of(const std::string& key) {
    if (key == "roughness")
      return absl::StrCat("expected the rms slope of the surface, ",
                          text_of(bounds_of("Material.roughness")));
    if (key == "fresnel") return "expected \"exact\" or \"schlick\"";
    if (key == "masking") return "expected \"v_groove\" or \"smith\"";
    if (key == "grazing") return "expected b, the fall of the emissivity towards grazing";
    if (key == "lobe_width") return "expected e, the width of the specular lobe";
    if (key == "bias") return "expected B of the first-surface distribution";
    if (key == "width") return "expected sigma of the first-surface distribution";
    if (key == "tau_deg" || key == "omega_deg")
      return "expected the angle of shadowing and obscuration in degrees";
    if (key == "gamma_um" || key == "lambda0_um")
      return "expected a length in micrometres (effective roughness)";
    return "expected a value";
  }

  [[nodiscard]] bool has_any(const OpticalProperty& p) const {
    return check_.has(p.table) || check_.has(p.file) ||
           std::any_of(p.value.begin(), p.value.end(),
                       [&](const char* key) { return check_.has(key); });
  }

  void lambert(const MaterialKind& kind) const {
    const OpticalProperty &emissivity = kind.property[0], &reflectance = kind.property[1];
    if (has_any(emissivity) && has_any(reflectance)) {
      check_.error(has_in(reflectance),
                   "stands beside the emissivity, expected only one of the two (they add up to 1)");
    } else if (!has_any(reflectance)) {
      property(emissivity);
      return;
    }
    if (has_any(emissivity)) property(emissivity);
    property(reflectance);
  }

  [[nodiscard]] const char* has_in(const OpticalProperty& p) const {
    for (const char* key : p.value)
      if (check_.has(key)) return key;
    return check_.has(p.table) ? p.table : p.file;
  }

  void property(const OpticalProperty& p) const {
    if (std::string(p.table) == "optical_constants") return constants(p);
    std::vector<const char*> forms = p.value;
    forms.push_back(p.table);
    forms.push_back(p.file);
    if (check_.at_most_one(forms) == 0) {
      check_.error(forms.front(),
                   absl::StrCat("is missing, expected ", p.value.empty() ? "" : "a number, ",
                                p.table, " or ", p.file));
    }
    unread(p);
    if (std::string(p.table) == "brdf") {
      if (material_.has_brdf()) brdf(material_.brdf());
      return;
    }
    const auto& points = table_of(p);
    if (points.size() == 0) return;
    const std::string at = check_.path(p.table);
    check_table(points, at, sweep_, findings_);
    for (int i = 0; i < points.size(); ++i) {
      const SectionCheck point(points[i], absl::StrCat(at, "[", i, "]"), findings_);
      point.require({"value"}, absl::StrCat("expected the ", p.name, " there"));
      point.within("value", 0, 1);
    }
  }

  [[nodiscard]] const google::protobuf::RepeatedPtrField<schema::SpectralPoint>& table_of(
      const OpticalProperty& p) const {
    const std::string table = p.table;
    if (table == "emissivity_table") return material_.emissivity_table();
    if (table == "reflectance_table") return material_.reflectance_table();
    if (table == "diffuse_reflectance_table") return material_.diffuse_reflectance_table();
    if (table == "specular_reflectance_table") return material_.specular_reflectance_table();
    return material_.volume_reflectance_table();
  }

  void constants(const OpticalProperty& p) const {
    const bool table = material_.optical_constants_size() > 0;
    const bool pair = material_.has_n() || material_.has_k();
    if (table && pair) {
      check_.error("optical_constants", "stands beside n or k, expected only one of the two forms");
    }
    if (check_.has(p.file) && (table || pair)) {
      check_.error(p.file, absl::StrCat("stands beside ", table ? "optical_constants" : "n or k",
                                        ", expected only one of the two forms"));
    }
    unread(p);
    if (table) {
      check_table(material_.optical_constants(), check_.path(p.table), sweep_, findings_);
      for (int i = 0; i < material_.optical_constants_size(); ++i) {
        const SectionCheck point(material_.optical_constants(i),
                                 absl::StrCat(check_.path(p.table), "[", i, "]"), findings_);
        point.require({"n", "k"}, "expected the optical constants n + i k");
      }
    } else if (!check_.has(p.file)) {
      check_.require({"n", "k"},
                     "expected the optical constants n + i k (or optical_constants, a table, or "
                     "optical_constants_file)");
    }
  }

  // read_material_files() has replaced every file that stands where it belongs.
  void unread(const OpticalProperty& p) const {
    if (!check_.has(p.file) || check_.has(p.table)) return;
    for (const char* key : p.value)
      if (check_.has(key)) return;
    check_.error(p.file, "was not read, expected its content in the sweep");
  }

  void brdf(const schema::BrdfTable& table) const {
    const std::string at = check_.path("brdf");
    const auto axis = [&](const char* name, const auto& values) {
      const std::string path = absl::StrCat(at, ".", name);
      if (values.empty()) findings_.add(at, path + " is missing, expected a list of numbers");
      for (int i = 1; i < values.size(); ++i) {
        const std::string here = absl::StrCat(path, "[", i, "]");
        if (!(values[i] > values[i - 1]) && !findings_.any_at(here))
          findings_.add(here, absl::StrCat(here, " = ", values[i],
                                           " is not above the one before it, expected increasing "
                                           "numbers"));
      }
    };
    axis("lambda_um", table.lambda_um());
    axis("theta_i_deg", table.theta_i_deg());
    axis("theta_r_deg", table.theta_r_deg());
    axis("phi_deg", table.phi_deg());
    if (findings_.any_at(at)) return;
    const double cells = 1.0 * table.lambda_um_size() * table.theta_i_deg_size() *
                         table.theta_r_deg_size() * table.phi_deg_size();
    if (cells != table.brdf_per_sr_size())
      findings_.add(
          at + ".brdf_per_sr",
          absl::StrCat(at, ".brdf_per_sr has ", table.brdf_per_sr_size(), " numbers, expected ",
                       cells, ": one for each wavelength, direction in and direction out"));
    if (table.lambda_um_size() > 1)
      check_covers(table.lambda_um(0), table.lambda_um(table.lambda_um_size() - 1), at, at, sweep_,
                   findings_);
  }

  void creates_energy(const char* form) const {
    if (!check_.has(form)) return;
    const bool asked = std::string(form) == "printed" ? material_.printed() : material_.published();
    if (asked && !material_.allow_energy_gain())
      check_.error(form,
                   "= true is the form that creates energy, expected allow_energy_gain = true "
                   "beside it, or false");
  }

  const schema::Material& material_;
  std::string path_;
  const schema::Sweep& sweep_;
  Findings& findings_;
  SectionCheck check_;
};

std::vector<const char*> all_kinds() {
  std::vector<const char*> kinds;
  for (const MaterialKind& kind : material_kinds()) kinds.push_back(kind.name);
  kinds.push_back("library");
  for (const std::string& name : built_in_names()) kinds.push_back(name.c_str());
  return kinds;
}

}  // namespace

std::vector<std::string> resolve_materials(schema::Sweep& sweep, Findings& findings) {
  std::vector<std::string> names = check_names(sweep.material(), "material", findings);
  for (int i = 0; i < sweep.material_size(); ++i) {
    schema::Material& material = *sweep.mutable_material(i);
    const std::string path = absl::StrCat("material[", i, "]");
    const SectionCheck check(material, path, findings);
    check.require({"kind"}, "expected \"lambert\", \"cook_torrance\", \"library\" ...");
    if (!check.one_of("kind", all_kinds())) continue;
    const std::string kind = material.kind();
    if (is_built_in(material.name()) && material.name() != kind) {
      check.error("name", absl::StrCat("\"", material.name(),
                                       "\" is built in with another meaning, expected another "
                                       "name"));
    }
    const MaterialCheck one(material, path, sweep, findings);
    if (kind == "library") {
      if (auto entry = one.from_library()) material = *std::move(entry);
    } else if (const MaterialKind* stated = find_material_kind(kind)) {
      one.stated(*stated);
    } else {
      one.hull();
    }
  }
  return names;
}

void resolve_part_material(const std::string& name, const SectionCheck& check,
                           std::vector<std::string>& known, schema::Sweep& sweep,
                           Findings& findings) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  if (name == "hull_paper") {
    check.error("material",
                "= \"hull_paper\" creates energy, expected a [[material]] of that kind with "
                "allow_energy_gain = true");
    return;
  }
  if (is_built_in(name)) {
    schema::Material& material = *sweep.add_material();
    material.set_name(name);
    material.set_kind(name);
    known.push_back(name);
    return;
  }
  if (const auto entry = library_entry(name); entry.ok()) {
    const WavelengthRange range = wavelength_range(entry->spec);
    if (!range.everywhere)
      check_covers(range.min_um, range.max_um, check.path("material"),
                   absl::StrCat(check.path("material"), ": the library's \"", name, "\""), sweep,
                   findings);
    if (auto message = message_of(entry->spec); message.ok()) {
      message->set_entry(name);
      *sweep.add_material() = *std::move(message);
    }
    known.push_back(name);
    return;
  }
  std::vector<std::string> all = known;
  for (const char* built_in : {"hull", "hull_index"}) {
    if (std::find(all.begin(), all.end(), built_in) == all.end()) all.emplace_back(built_in);
  }
  for (const LibraryEntry& entry : material_library()) {
    if (std::find(all.begin(), all.end(), entry.spec.name) == all.end())
      all.push_back(entry.spec.name);
  }
  check.error("material",
              absl::StrCat("= \"", name, "\" is no known material: ", suggestion(name, all)));
}

absl::StatusOr<std::vector<schema::Material>> resolved_materials(const SweepFile& file) {
  schema::Sweep sweep = file.sweep;
  Findings findings(file);
  for (int i = 0; i < sweep.material_size(); ++i)
    check_numbers(sweep.material(i), absl::StrCat("material[", i, "]"), findings);
  std::vector<std::string> known = resolve_materials(sweep, findings);
  for (int i = 0; i < sweep.part_size(); ++i) {
    const SectionCheck check(sweep.part(i), absl::StrCat("part[", i, "]"), findings);
    if (sweep.part(i).has_material())
      resolve_part_material(sweep.part(i).material(), check, known, sweep, findings);
  }
  resolve_land_materials(known, sweep, findings);
  if (!findings.empty()) return findings.status();
  return std::vector<schema::Material>(sweep.material().begin(), sweep.material().end());
}

}  // namespace irsig
