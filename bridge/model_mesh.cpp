#include "bridge/model_mesh.h"

#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "core/scene/cut_edges.h"

namespace irsig {
namespace {

// Of facets that element_size_m makes: temperatures of a day take a second for a thousand of them.
constexpr std::uint64_t kMostElements = 1'000'000;

absl::Status at(const std::string& path, const absl::Status& status) {
  return {status.code(), absl::StrCat(path, ": ", status.message())};
}

absl::StatusOr<Mesh> mesh_as_it_is(const schema::ResolvedSweep& sweep, const Assets& assets) {
  const schema::Model& model = sweep.sweep().model();
  if (model.has_generate()) {
    MeshGenerator generator;
    generator.kind = model.generate();
    generator.triangles = model.triangles();
    generator.radius_m = model.radius_m();
    generator.length_m = model.length_m();
    generator.width_m = model.width_m();
    generator.height_m = model.height_m();
    auto mesh = generate_mesh(generator);
    return mesh.ok() ? mesh : absl::StatusOr<Mesh>(at("model.generate", mesh.status()));
  }
  MeshImport how;
  how.file_name = sweep.model_file_name();
  how.unit_m = model.unit_m();
  how.forward_axis = model.forward_axis();
  how.up_axis = model.up_axis();
  how.reference = model.reference();
  auto mesh = import_mesh(asset(assets, sweep.model_sha256()), how);
  return mesh.ok() ? mesh : absl::StatusOr<Mesh>(at("model.file", mesh.status()));
}

}  // namespace

absl::StatusOr<Mesh> model_mesh(const schema::ResolvedSweep& sweep, const Assets& assets) {
  auto mesh = mesh_as_it_is(sweep, assets);
  if (!mesh.ok()) return mesh;
  const schema::Model& model = sweep.sweep().model();
  MeshPlacement where;
  if (model.has_draft_m()) where.draft_m = model.draft_m();
  if (model.offset_m_size() == 3)
    where.offset_m = {model.offset_m(0), model.offset_m(1), -model.offset_m(2)};
  if (model.has_draft_m() || model.offset_m_size() > 0) place(*mesh, where);
  if (!sweep.sweep().heat().has_element_size_m()) return mesh;
  auto cut = cut_long_edges(*mesh, sweep.sweep().heat().element_size_m(), kMostElements);
  return cut.ok() ? cut : absl::StatusOr<Mesh>(at("heat.element_size_m", cut.status()));
}

}  // namespace irsig
