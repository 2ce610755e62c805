#include "jobs/resolve_land_objects.h"

#include <algorithm>
#include <set>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/printable.h"
#include "jobs/text/nearest_name.h"

namespace irsig {
namespace {

bool ends(const std::string& file, std::initializer_list<const char*> endings) {
  return std::any_of(endings.begin(), endings.end(),
                     [&](const char* ending) { return absl::EndsWithIgnoreCase(file, ending); });
}

// Formats whose standard states the unit and the axes.
bool states_frame(const schema::LandObject& object) {
  return ends(object.model(), {".gltf", ".glb"});
}

void check_object_model(const schema::LandObject& object, const SectionCheck& check) {
  check.require({"model"}, "expected a mesh file: .obj, .ply, .stl, .gltf or .glb");
  if (object.has_model() && !ends(object.model(), {".obj", ".ply", ".stl", ".gltf", ".glb"}))
    check.error("model", absl::StrCat("= \"", one_line(object.model()),
                                      "\", expected a file that ends in .obj, .ply, .stl, .gltf "
                                      "or .glb"));
  if (!states_frame(object)) {
    check.require(
        {"unit_m"},
        "expected the length of one unit of the file in metres (1, or 0.001 for millimetres)");
    check.require({"forward_axis", "up_axis"},
                  "expected the file's axis, one of \"+x\", \"-x\", \"+y\", \"-y\", \"+z\", "
                  "\"-z\"");
  }
  const bool forward = check.one_of("forward_axis", {"+x", "-x", "+y", "-y", "+z", "-z"});
  const bool up = check.one_of("up_axis", {"+x", "-x", "+y", "-y", "+z", "-z"});
  if (forward && up && object.forward_axis()[1] == object.up_axis()[1])
    check.error("up_axis",
                absl::StrCat("= \"", object.up_axis(),
                             "\" is parallel to forward_axis, expected an axis at a right angle"));
  (void)check.one_of("reference", {"origin", "bbox_center", "bbox_bottom_center"});
}

// The materials of the land: all names, and those that cover ground.
struct LandMaterials {
  std::vector<std::string> all, ground;
};

// A key that names a material of the land.
void check_name(const std::string& name, const char* key, const SectionCheck& check,
                const std::vector<std::string>& known, const char* what) {
  if (check.has(key) && std::find(known.begin(), known.end(), name) == known.end())
    check.error(key, absl::StrCat("= \"", one_line(name), "\" is no ", what, ", ",
                                  suggestion(name, known)));
}

void check_object_materials(const schema::LandObject& object, const std::string& path,
                            const LandMaterials& materials, const SectionCheck& check,
                            Findings& findings) {
  constexpr const char* kMaterial = "[[land.material]]";
  check_name(object.material(), "material", check, materials.all, kMaterial);
  if (!object.has_material() && object.part_size() == 0)
    check.error("material",
                "is missing, expected the name of a [[land.material]], or [[land.object.part]] "
                "with the materials of the model's groups");
  for (int i = 0; i < object.part_size(); ++i) {
    const SectionCheck part(object.part(i), absl::StrCat(path, ".part[", i, "]"), findings);
    part.require({"match"}, "expected the name of a group of the model, with * and ?");
    part.require({"material"}, "expected the name of a [[land.material]]");
    check_name(object.part(i).material(), "material", part, materials.all, kMaterial);
    if (object.part(i).has_match() && object.part(i).match().empty())
      part.error("match", "is empty, expected the name of a group of the model, with * and ?");
  }
}

void check_places(const schema::LandObject& object, const std::string& path,
                  const LandMaterials& materials, const SectionCheck& check, Findings& findings) {
  if (check.at_most_one({"place", "places_file", "count"}) == 0)
    check.error("place",
                "is missing, expected [[land.object.place]] with east_m and north_m, or "
                "places_file, or count");
  for (int i = 0; i < object.place_size(); ++i)
    SectionCheck(object.place(i), absl::StrCat(path, ".place[", i, "]"), findings)
        .require({"east_m", "north_m"}, "expected metres from the target");
  if (object.has_places_file() && !ends(object.places_file(), {".csv"}))
    check.error("places_file", absl::StrCat("= \"", one_line(object.places_file()),
                                            "\", expected a file that ends in .csv"));
  if (!object.has_count()) {
    for (const char* key : {"seed", "within", "inner_radius_m", "radius_m"})
      if (check.has(key)) check.error(key, "does not apply without count");
    return;
  }
  check.require({"within"}, "expected the material of the ground on which the objects stand");
  check.require({"inner_radius_m"},
                "expected the distance from the target below which no object stands");
  check.require({"radius_m"}, "expected the distance from the target up to which objects stand");
  check_name(object.within(), "within", check, materials.ground,
             "[[land.material]] that covers ground");
  if (object.has_inner_radius_m() && object.has_radius_m() &&
      !(object.inner_radius_m() < object.radius_m()))
    check.error("inner_radius_m",
                absl::StrCat("= ", object.inner_radius_m(),
                             " is not below radius_m = ", object.radius_m(), ", expected a ring"));
}

}  // namespace

std::string land_object_path(int i) { return absl::StrCat("land.object[", i, "]"); }

void add_land_object_files(const schema::Land& land, std::map<std::string, std::string>& files) {
  for (int i = 0; i < land.object_size(); ++i) {
    const schema::LandObject& object = land.object(i);
    if (object.has_model()) files[land_object_path(i) + ".model"] = object.model();
    if (object.has_places_file())
      files[land_object_path(i) + ".places_file"] = object.places_file();
  }
}

void check_land_objects(const schema::Land& land, Findings& findings) {
  LandMaterials materials;
  for (const schema::LandMaterial& material : land.material()) {
    materials.all.push_back(material.material());
    if (!material.objects_only()) materials.ground.push_back(material.material());
  }
  std::set<std::string> used;
  for (int i = 0; i < land.object_size(); ++i) {
    const schema::LandObject& object = land.object(i);
    const std::string path = land_object_path(i);
    const SectionCheck check(object, path, findings);
    check_object_model(object, check);
    check_object_materials(object, path, materials, check, findings);
    check_places(object, path, materials, check, findings);
    used.insert(object.material());
    for (const schema::LandObjectPart& part : object.part()) used.insert(part.material());
  }
  for (int i = 0; i < land.material_size(); ++i)
    if (land.material(i).objects_only() && !used.contains(land.material(i).material()))
      SectionCheck(land.material(i), absl::StrCat("land.material[", i, "]"), findings)
          .error("objects_only",
                 "= true, but no [[land.object]] has this material; delete the table, or name the "
                 "material of an object");
}

void write_land_object_defaults(schema::Land& land) {
  for (schema::LandObject& object : *land.mutable_object()) {
    if (states_frame(object)) {
      if (!object.has_unit_m()) object.set_unit_m(1);
      if (!object.has_forward_axis()) object.set_forward_axis("+z");
      if (!object.has_up_axis()) object.set_up_axis("+y");
    }
    if (!object.has_reference()) object.set_reference("bbox_bottom_center");
    if (!object.has_scale()) object.set_scale(1);
    if (!object.has_sink_m()) object.set_sink_m(0);
    if (object.has_count() && !object.has_seed()) object.set_seed(1);
    for (schema::LandObjectPlace& place : *object.mutable_place()) {
      if (!place.has_heading_deg()) place.set_heading_deg(0);
      if (!place.has_scale()) place.set_scale(object.scale());
    }
  }
}

}  // namespace irsig
