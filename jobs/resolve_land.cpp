#include "jobs/resolve_land.h"

#include <algorithm>
#include <map>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/land/height_raster.h"
#include "jobs/keys/expand.h"
#include "jobs/land_build_ups.h"
#include "jobs/resolve.h"
#include "jobs/resolve_land_objects.h"
#include "jobs/text/nearest_name.h"
#include "schema/heat_run.h"

namespace irsig {
namespace {

std::string land_material_path(int i) { return absl::StrCat("land.material[", i, "]"); }

// The files that [land] names, by the key of each.
std::map<std::string, std::string> land_files(const schema::Land& land) {
  std::map<std::string, std::string> out;
  if (land.has_heights()) out["land.heights"] = land.heights();
  if (land.has_inset()) out["land.inset"] = land.inset();
  for (int i = 0; i < land.material_size(); ++i)
    if (land.material(i).has_fraction_file())
      out[land_material_path(i) + ".fraction_file"] = land.material(i).fraction_file();
  add_land_object_files(land, out);
  return out;
}

std::string without_folders(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

bool ends_in(const std::string& file, std::initializer_list<const char*> endings) {
  return std::any_of(endings.begin(), endings.end(),
                     [&](const char* ending) { return absl::EndsWithIgnoreCase(file, ending); });
}

// A map's file, and the coordinates that an .asc does not state.
struct MapKeys {
  const char *file, *epsg;
  bool heights;
};
void check_map_file(const std::string& file, std::uint32_t epsg, const MapKeys& keys,
                    const SectionCheck& check) {
  if (!check.has(keys.file)) {
    if (check.has(keys.epsg))
      check.error(keys.epsg, absl::StrCat("does not apply without ", keys.file));
    return;
  }
  const bool asc = ends_in(file, {".asc"});
  if (!asc && !ends_in(file, {".tif", ".tiff"}) && !(keys.heights && ends_in(file, {".hgt"}))) {
    check.error(keys.file, absl::StrCat("= \"", one_line(file), "\", expected a file that ends in ",
                                        keys.heights ? ".hgt, " : "", ".tif, .tiff or .asc"));
  } else if (check.has(keys.epsg) && !asc) {
    check.error(keys.epsg, absl::StrCat("= ", epsg, " does not apply to \"", one_line(file),
                                        "\", which states its coordinates itself; delete the key"));
  } else if (check.has(keys.epsg)) {
    if (const auto system = map_system(epsg); !system.ok())
      check.error(keys.epsg, absl::StrCat("= ", epsg, ": ", system.status().message()));
  }
}

// The tables without which land has no place, no sky and nothing beyond its map.
void check_other_tables(const schema::Sweep& sweep, Findings& findings) {
  if (!has_position(sweep))
    findings.add("land",
                 "[land] needs [place], expected latitude_deg, longitude_deg and heading_deg: the "
                 "map lies around the target");
  if (sweep.has_plume())
    findings.add(
        "plume",
        "[plume] does not go with [land]: hot gas before land is not modelled; delete one of "
        "the tables");
  if (sweep.profile_size() > 0)
    findings.add("profile[0]",
                 "[[profile]] does not go with [land]: profiles see the ground behind the target; "
                 "delete one of the tables");
  const auto kind = [&](const schema::Surroundings& s, const std::string& path) {
    if (s.has_kind() && s.kind() != "ground")
      findings.add(path + ".kind",
                   absl::StrCat(path, ".kind = \"", s.kind(),
                                "\" does not go with [land], expected kind = \"ground\": the "
                                "ground lies beyond the edge of the map"));
  };
  kind(sweep.surroundings(), "surroundings");
  for (int s = 0; s < sweep.season_size(); ++s)
    kind(sweep.season(s).surroundings(), absl::StrCat("season[", s, "].surroundings"));
  if (sweep.air().has_model() && sweep.air().model() != "atmosphere")
    findings.add("air.model",
                 absl::StrCat("air.model = \"", sweep.air().model(),
                              "\" does not go with [land], expected model = \"atmosphere\": the "
                              "sky above the land is the atmosphere's"));
}

// Returns the other ways to a temperature of a material whose temperature is stated nowhere.
std::string remedy_without_temperature(const schema::Sweep& sweep, const std::string& entry) {
  if (entry == "sea_water")
    return "; the temperature of water is not computed: water flows and mixes";
  if (entry == "leaves") return "; the temperature of leaves is not computed";
  if (sweep.has_heat()) return ", or build_up = \"...\", from which [heat] computes it";
  return has_land_build_up(entry) ? ", or [heat], which computes it from the weather" : "";
}

// Every material has a temperature in every season: its own, the season's, or a computed one.
void check_land_temperature(const schema::Sweep& sweep, const schema::LandMaterial& material,
                            const SectionCheck& check) {
  if (material.has_temperature_k() || material.has_build_up()) return;
  std::set<std::string> without;
  for (const schema::Season& season : sweep.season())
    if (!is_stated(season, material)) without.insert(season.name());
  if (without.empty() && sweep.season_size() > 0) return;
  const auto stated =
      std::find_if(sweep.material().begin(), sweep.material().end(),
                   [&](const schema::Material& m) { return m.name() == material.material(); });
  check.error(
      "temperature_k",
      absl::StrCat("is missing",
                   without.empty()
                       ? ""
                       : absl::StrCat(" in season ", quoted_list({without.begin(), without.end()})),
                   ", expected temperature_k here, or \"", material.material(),
                   "\" in land_temperature_k of every season",
                   remedy_without_temperature(
                       sweep, stated == sweep.material().end() ? "" : stated->entry())));
}

// Materials whose temperatures are computed need what walls of parts need.
void check_land_build_up(const schema::Sweep& sweep, const schema::LandMaterial& material,
                         const SectionCheck& check) {
  if (!material.has_build_up()) return;
  if (!sweep.has_heat())
    check.error("build_up", absl::StrCat("= \"", one_line(material.build_up()),
                                         "\", but [heat] is missing, expected it: the temperature "
                                         "of the land is computed"));
  else if (material.has_temperature_k())
    check.error("build_up",
                "stands beside temperature_k, which would be taken: expected only one of the two");
}

void check_cover(const schema::Sweep& sweep, Findings& findings) {
  const schema::Land& land = sweep.land();
  if (land.material_size() == 0)
    findings.add("land",
                 "[[land.material]] is missing, expected one or more with material and "
                 "temperature_k");
  if (land.material_size() > 0 &&
      std::all_of(land.material().begin(), land.material().end(),
                  [](const schema::LandMaterial& m) { return m.objects_only(); }))
    findings.add("land",
                 "every [[land.material]] has objects_only = true, expected a material that covers "
                 "the ground");
  std::map<std::string, int> seen;
  int remainder = -1;
  for (int i = 0; i < land.material_size(); ++i) {
    const schema::LandMaterial& material = land.material(i);
    const SectionCheck check(material, land_material_path(i), findings);
    check.require({"material"}, "expected the name of a material");
    check_map_file(material.fraction_file(), material.fraction_epsg(),
                   {"fraction_file", "fraction_epsg", false}, check);
    if (material.objects_only()) {
      if (material.has_fraction_file())
        check.error("fraction_file",
                    "does not apply with objects_only = true, which covers no ground; delete one "
                    "of the keys");
    } else if (!material.has_fraction_file() && remainder >= 0) {
      check.error("fraction_file",
                  absl::StrCat("is missing, as it is in ", land_material_path(remainder),
                               ", expected at most one material without a file, which takes what "
                               "the others leave"));
    } else if (!material.has_fraction_file()) {
      remainder = i;
    }
    if (!material.has_material()) continue;
    const auto [first, is_new] = seen.try_emplace(material.material(), i);
    if (!is_new)
      check.error("material",
                  absl::StrCat("= \"", one_line(material.material()), "\" is also that of ",
                               land_material_path(first->second), ", expected each material once"));
    check_land_temperature(sweep, material, check);
    check_land_build_up(sweep, material, check);
  }
}

void check_stated_names(const schema::Sweep& sweep, Findings& findings) {
  std::vector<std::string> names;
  for (const schema::LandMaterial& material : sweep.land().material())
    names.push_back(material.material());
  for (int s = 0; s < sweep.season_size(); ++s) {
    const std::string path = absl::StrCat("season[", s, "].land_temperature_k");
    // In the order of their names: a map has none.
    const std::map<std::string, double> stated(sweep.season(s).land_temperature_k().begin(),
                                               sweep.season(s).land_temperature_k().end());
    if (!stated.empty() && !sweep.has_land()) {
      findings.add(path, absl::StrCat(path, " does not apply without [land]"));
      continue;
    }
    for (const auto& [name, k] : stated)
      if (std::find(names.begin(), names.end(), name) == names.end())
        findings.add(absl::StrCat(path, ".", name),
                     absl::StrCat(path, ".", name, ": the land has no material \"", one_line(name),
                                  "\", ", suggestion(name, names)));
  }
}

void check_land_file(const schema::LandFile& file, const std::string& path, Findings& findings) {
  const std::string& hash = file.sha256();
  if (hash.size() != 64 || hash.find_first_not_of("0123456789abcdef") != std::string::npos)
    findings.add(
        path, absl::StrCat(path, ".sha256 = \"", one_line(hash), "\", expected a SHA-256 in hex"));
  if (file.file_name().empty() || absl::StrContains(file.file_name(), '/') ||
      !is_one_line(file.file_name()))
    findings.add(path, absl::StrCat(path, ".file_name = \"", one_line(file.file_name()),
                                    "\", expected a name without folders"));
}

// A condition names the run that computes its land exactly if some of its land has no temperature.
void check_land_heat(const schema::ResolvedSweep& resolved, Findings& findings) {
  const int materials = resolved.sweep().land().material_size();
  for (int h = 0; h < resolved.heat_size(); ++h)
    if (const schema::HeatRun& run = resolved.heat(h);
        run.land_temperature_k_size() != 0 && run.land_temperature_k_size() != materials)
      findings.add(
          absl::StrCat("heat[", h, "]"),
          absl::StrCat("heat[", h, "].land_temperature_k has ", run.land_temperature_k_size(),
                       " elements for ", materials, " materials of the land"));
    else if (computes_land(run))
      for (int m = 0; m < materials; ++m)
        if (run.land_temperature_k(m) == 0 && !resolved.sweep().land().material(m).has_build_up())
          findings.add(absl::StrCat("heat[", h, "]"),
                       absl::StrCat("heat[", h, "] computes ", land_material_path(m),
                                    ", which has no build_up"));
  for (int c = 0; c < resolved.condition_size(); ++c) {
    const schema::Condition& condition = resolved.condition(c);
    const std::string path = absl::StrCat("condition[", c, "]");
    const auto add = [&](const std::string& what) { findings.add(path, path + what); };
    const auto& kelvin = condition.land_temperature_k();
    const bool computed = std::find(kelvin.begin(), kelvin.end(), 0.0) != kelvin.end();
    if (computed != condition.has_land_heat())
      add(computed ? ".land_temperature_k = 0 without a land_heat that computes it"
                   : ".land_heat does not apply: all land_temperature_k are stated");
    else if (computed && condition.land_heat() >= static_cast<std::uint32_t>(resolved.heat_size()))
      add(absl::StrCat(".land_heat = ", condition.land_heat(), ": there is no such run"));
    else if (computed) {
      const schema::HeatRun& run = resolved.heat(static_cast<int>(condition.land_heat()));
      if (!computes_land(run) ||
          !std::equal(kelvin.begin(), kelvin.end(), run.land_temperature_k().begin(),
                      run.land_temperature_k().end()))
        add(absl::StrCat(".land_heat = ", condition.land_heat(),
                         " is a run of other land than land_temperature_k"));
    }
  }
}

}  // namespace

absl::Status read_land_files(SweepFile& file, const FileReader& read) {
  Problems wrong;
  for (const auto& [path, name] : land_files(file.sweep.land())) {
    if (name.empty()) continue;  // reported for its ending
    auto bytes = read(name);
    if (bytes.ok() && !bytes->empty())
      file.content[path] = *std::move(bytes);
    else
      wrong.add(placed_problem(
          file.location(path),
          absl::StrCat(path, " = \"", one_line(name),
                       "\": ", bytes.ok() ? "is empty" : std::string(bytes.status().message()))));
  }
  return wrong.status();
}

std::map<std::string, std::string_view> land_bytes(const SweepFile& file) {
  std::map<std::string, std::string_view> out;
  for (const auto& [path, name] : land_files(file.sweep.land()))
    if (const auto at = file.content.find(path); at != file.content.end()) out[path] = at->second;
  return out;
}

void check_land(const schema::Sweep& sweep, Findings& findings) {
  check_stated_names(sweep, findings);
  if (!sweep.has_land()) return;
  const schema::Land& land = sweep.land();
  const SectionCheck check(land, "land", findings);
  check.require({"heights"}, "expected a file of heights: .hgt, .tif, .tiff or .asc");
  check_map_file(land.heights(), land.epsg(), {"heights", "epsg", true}, check);
  check_map_file(land.inset(), land.inset_epsg(), {"inset", "inset_epsg", true}, check);
  if (land.has_width_m() && land.has_spacing_m() && land.spacing_m() > land.width_m())
    check.error("spacing_m", absl::StrCat("= ", land.spacing_m(), " is above width_m = ",
                                          land.width_m(), ", expected at most that"));
  check_other_tables(sweep, findings);
  check_cover(sweep, findings);
  check_land_objects(land, findings);
}

bool is_stated(const schema::Season& season, const schema::LandMaterial& material) {
  return material.has_temperature_k() || season.land_temperature_k().contains(material.material());
}

std::vector<int> computed_land(const schema::Sweep& sweep, const schema::Season& season) {
  std::vector<int> out;
  for (int m = 0; m < sweep.land().material_size(); ++m)
    if (const schema::LandMaterial& material = sweep.land().material(m);
        material.has_build_up() && !is_stated(season, material))
      out.push_back(m);
  return out;
}

void write_land_defaults(schema::Sweep& sweep) {
  if (!sweep.has_land()) return;
  if (!sweep.land().has_geoid_m()) sweep.mutable_land()->set_geoid_m(0);
  write_land_object_defaults(*sweep.mutable_land());
}

void resolve_land_materials(std::vector<std::string>& known, schema::Sweep& sweep,
                            Findings& findings) {
  for (int i = 0; i < sweep.land().material_size(); ++i) {
    const schema::LandMaterial material = sweep.land().material(i);
    if (material.has_material())
      resolve_part_material(material.material(), {material, land_material_path(i), findings}, known,
                            sweep, findings);
  }
}

void take_land_temperatures(const schema::Sweep& sweep, const schema::Season& season,
                            schema::Condition& condition) {
  for (const schema::LandMaterial& material : sweep.land().material()) {
    const auto stated = season.land_temperature_k().find(material.material());
    condition.add_land_temperature_k(
        stated != season.land_temperature_k().end() ? stated->second : material.temperature_k());
  }
}

void resolve_land(const SweepFile& file, schema::ResolvedSweep& resolved) {
  if (!resolved.sweep().has_land()) return;
  schema::Land& land = *resolved.mutable_sweep()->mutable_land();
  schema::LandFiles& files = *resolved.mutable_land();
  const auto take = [&](const std::string& path, const std::string& name, schema::LandFile& out) {
    const auto at = file.content.find(path);
    out.set_sha256(sha256_hex(at == file.content.end() ? std::string() : at->second));
    out.set_file_name(without_folders(name));
  };
  take("land.heights", land.heights(), *files.mutable_heights());
  if (land.has_inset()) take("land.inset", land.inset(), *files.mutable_inset());
  for (int i = 0; i < land.material_size(); ++i) {
    schema::LandFile& fraction = *files.add_fraction();
    if (land.material(i).has_fraction_file())
      take(land_material_path(i) + ".fraction_file", land.material(i).fraction_file(), fraction);
    land.mutable_material(i)->clear_fraction_file();
  }
  for (int i = 0; i < land.object_size(); ++i) {
    schema::LandObject& object = *land.mutable_object(i);
    schema::LandObjectFiles& of_object = *files.add_object();
    const std::string path = land_object_path(i);
    take(path + ".model", object.model(), *of_object.mutable_model());
    if (object.has_places_file())
      take(path + ".places_file", object.places_file(), *of_object.mutable_places());
    object.clear_model();
    object.clear_places_file();
  }
  land.clear_heights();
  land.clear_inset();
}

schema::Land land_as_written(const schema::ResolvedSweep& resolved) {
  schema::Land land = resolved.sweep().land();
  const schema::LandFiles& files = resolved.land();
  land.set_heights(files.heights().file_name());
  if (files.has_inset()) land.set_inset(files.inset().file_name());
  for (int i = 0; i < std::min(land.material_size(), files.fraction_size()); ++i)
    if (!files.fraction(i).file_name().empty())
      land.mutable_material(i)->set_fraction_file(files.fraction(i).file_name());
  for (int i = 0; i < std::min(land.object_size(), files.object_size()); ++i) {
    land.mutable_object(i)->set_model(files.object(i).model().file_name());
    if (files.object(i).has_places())
      land.mutable_object(i)->set_places_file(files.object(i).places().file_name());
  }
  return land;
}

void check_resolved_land(const schema::ResolvedSweep& resolved, Findings& findings) {
  const schema::Land& land = resolved.sweep().land();
  const schema::LandFiles& files = resolved.land();
  if (resolved.has_land() != resolved.sweep().has_land()) {
    findings.add(
        "land",
        absl::StrCat("land ", resolved.has_land() ? "does not apply without" : "is missing with",
                     " sweep.land"));
    return;
  }
  for (int c = 0; c < resolved.condition_size(); ++c)
    if (resolved.condition(c).land_temperature_k_size() != land.material_size())
      findings.add(absl::StrCat("condition[", c, "]"),
                   absl::StrCat("condition[", c, "].land_temperature_k has ",
                                resolved.condition(c).land_temperature_k_size(), " elements for ",
                                land.material_size(), " materials of the land"));
  check_land_heat(resolved, findings);
  if (!resolved.has_land()) return;
  check_land_file(files.heights(), "land.heights", findings);
  if (files.has_inset()) check_land_file(files.inset(), "land.inset", findings);
  if (files.fraction_size() != land.material_size())
    findings.add("land.fraction",
                 absl::StrCat("land.fraction has ", files.fraction_size(), " elements for ",
                              land.material_size(), " materials"));
  for (int i = 0; i < files.fraction_size(); ++i)
    if (!files.fraction(i).sha256().empty() || !files.fraction(i).file_name().empty())
      check_land_file(files.fraction(i), absl::StrCat("land.fraction[", i, "]"), findings);
  if (files.object_size() != land.object_size())
    findings.add("land.object", absl::StrCat("land.object has files of ", files.object_size(),
                                             " objects for ", land.object_size(), " tables"));
  for (int i = 0; i < files.object_size(); ++i) {
    const std::string path = land_object_path(i);
    check_land_file(files.object(i).model(), path + ".model", findings);
    if (files.object(i).has_places())
      check_land_file(files.object(i).places(), path + ".places_file", findings);
  }
}

}  // namespace irsig
