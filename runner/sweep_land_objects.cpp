#include "runner/sweep_land_objects.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/land/objects/object_places.h"
#include "core/land/objects/read_places.h"
#include "core/scene/import/import_mesh.h"

namespace irsig {
namespace {

absl::Status object_error(const std::string& key, const absl::Status& status) {
  return absl::IsInvalidArgument(status) ? at_key(key, status) : status;
}

std::uint32_t number_of(const schema::Land& land, const std::string& material) {
  int i = 0;
  while (i < land.material_size() && land.material(i).material() != material) ++i;
  return static_cast<std::uint32_t>(i);
}

std::string first_groups(const Mesh& mesh) {
  constexpr std::size_t kMost = 8;
  std::string out;
  for (std::size_t g = 0; g < std::min(kMost, mesh.group.size()); ++g)
    absl::StrAppend(&out, g > 0 ? ", " : "", "\"", mesh.group[g], "\"");
  return mesh.group.size() > kMost ? out + " ..." : out;
}

// The land's material of each group of a mesh.
absl::StatusOr<std::vector<std::uint32_t>> materials_of(const schema::Land& land,
                                                        const schema::LandObject& object,
                                                        const Mesh& mesh, const std::string& key) {
  std::vector<std::uint32_t> out;
  std::vector<bool> used(static_cast<std::size_t>(object.part_size()), false);
  for (const std::string& group : mesh.group) {
    std::optional<std::string> material;
    for (int p = 0; p < object.part_size() && !material; ++p)
      if (group_matches(group, object.part(p).match())) {
        material = object.part(p).material();
        used[static_cast<std::size_t>(p)] = true;
      }
    if (!material && object.has_material()) material = object.material();
    if (!material)
      return keyed_problem(key, absl::StrCat("no part matches group \"", group,
                                             "\" of the model; add [[land.object.part]], or state "
                                             "material for all other groups"));
    out.push_back(number_of(land, *material));
    if (out.back() >= static_cast<std::uint32_t>(land.material_size()))
      return keyed_problem(key, absl::StrCat("the land has no material \"", *material, "\""));
  }
  for (std::size_t p = 0; p < used.size(); ++p)
    if (!used[p])
      return keyed_problem(
          absl::StrCat(key, ".part[", p, "].match"),
          absl::StrCat("\"", object.part(static_cast<int>(p)).match(),
                       "\" matches no group of the model that an earlier part leaves; its groups "
                       "are: ",
                       first_groups(mesh)));
  return out;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const LandObjects>> land_objects_from_sweep(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeightField& field,
    const LandCover& cover) {
  const schema::Land& land = sweep.sweep().land();
  if (land.object_size() == 0) return nullptr;
  std::vector<ObjectModel> models;
  for (int i = 0; i < land.object_size(); ++i) {
    const schema::LandObject& object = land.object(i);
    const schema::LandObjectFiles& files = sweep.land().object(i);
    ObjectModel& model = models.emplace_back();
    model.key = absl::StrCat("land.object[", i, "]");
    model.sink_m = object.sink_m();
    MeshImport how;
    how.file_name = files.model().file_name();
    how.unit_m = object.unit_m();
    how.forward_axis = object.forward_axis();
    how.up_axis = object.up_axis();
    how.reference = object.reference();
    auto mesh = import_mesh(asset(assets, files.model().sha256()), how);
    if (!mesh.ok()) return object_error(model.key + ".model", mesh.status());
    model.mesh = *std::move(mesh);
    ASSIGN_OR_RETURN(model.material, materials_of(land, object, model.mesh, model.key));
    if (files.has_places()) {
      model.from = PlacesFrom::kFile;
      model.place_file = files.places().file_name();
      auto places =
          read_places(asset(assets, files.places().sha256()), model.place_file, object.scale());
      if (!places.ok()) return object_error(model.key + ".places_file", places.status());
      model.place = *std::move(places);
    } else if (object.has_count()) {
      model.from = PlacesFrom::kScatter;
      auto places =
          scatter_objects({object.count(), object.seed(), object.inner_radius_m(),
                           object.radius_m(), number_of(land, object.within()), object.scale()},
                          base_of(model.mesh), field, cover);
      if (!places.ok()) return object_error(model.key + ".count", places.status());
      model.place = *std::move(places);
    } else {
      for (const schema::LandObjectPlace& place : object.place())
        model.place.push_back(
            {place.east_m(), place.north_m(), place.heading_deg(), place.scale(), 0});
    }
  }
  ASSIGN_OR_RETURN(auto objects, LandObjects::create(std::move(models), field));
  return std::make_shared<const LandObjects>(std::move(objects));
}

}  // namespace irsig
