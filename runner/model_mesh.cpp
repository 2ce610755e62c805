#include "runner/model_mesh.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/scene/cut_edges.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/scene/import/import_mesh.h"

namespace irsig {
namespace {

// Largest number of facets that element_size_m may create: a day of temperatures takes about a
// second per thousand facets.
constexpr std::uint64_t kMostElements = 1'000'000;
// Distance to a surface, as a fraction of the mesh's size, within which a point touches the
// surface.
constexpr double kTouching = 1e-5;

double size_m(const Mesh& mesh) {
  Vec<Body> low = mesh.vertex.front(), high = low;
  for (const Vec<Body>& v : mesh.vertex) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  return length(high - low);
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
    return mesh.ok() ? mesh : absl::StatusOr<Mesh>(at_key("model.generate", mesh.status()));
  }
  MeshImport how;
  how.file_name = sweep.model_file_name();
  how.unit_m = model.unit_m();
  how.forward_axis = model.forward_axis();
  how.up_axis = model.up_axis();
  how.reference = model.reference();
  auto mesh = import_mesh(asset(assets, sweep.model_sha256()), how);
  return mesh.ok() ? mesh : absl::StatusOr<Mesh>(at_key("model.file", mesh.status()));
}

absl::StatusOr<Mesh> placed_mesh(const schema::ResolvedSweep& sweep, const Assets& assets) {
  auto mesh = mesh_as_it_is(sweep, assets);
  if (!mesh.ok()) return mesh;
  const schema::Model& model = sweep.sweep().model();
  MeshPlacement where;
  if (model.has_draft_m()) where.draft_m = model.draft_m();
  if (model.offset_m_size() == 3)
    where.offset_m = {model.offset_m(0), model.offset_m(1), -model.offset_m(2)};
  if (model.has_draft_m() || model.offset_m_size() > 0) place(*mesh, where);
  return mesh;
}

// Where temperatures are computed: at the surface, as a facet is in water, or ground, as a whole;
// and as element_size_m says.
absl::StatusOr<Mesh> cut(Mesh mesh, const schema::Sweep& sweep, std::vector<CutVertex>& made) {
  if (!sweep.has_heat()) return mesh;
  const auto by_number = [](const schema::TemperatureField& f) { return f.match() == "index"; };
  if (std::ranges::none_of(sweep.temperature_field(), by_number))
    mesh = cut_at_surface(mesh, kTouching * size_m(mesh), made);
  if (!sweep.heat().has_element_size_m()) return mesh;
  auto out = cut_long_edges(mesh, sweep.heat().element_size_m(), kMostElements, made);
  if (out.ok()) return out;
  return keyed_problem(
      "heat.element_size_m",
      absl::StrCat(out.status().message(), "; the model is ", absl::SixDigits(size_m(mesh)),
                   " m large",
                   sweep.model().has_file()
                       ? absl::StrCat(": is model.unit_m = ", sweep.model().unit_m(), " right?")
                       : ""));
}

}  // namespace

absl::StatusOr<Mesh> model_mesh(const schema::ResolvedSweep& sweep, const Assets& assets) {
  auto mesh = placed_mesh(sweep, assets);
  if (!mesh.ok()) return mesh;
  std::vector<CutVertex> made;
  return cut(*std::move(mesh), sweep.sweep(), made);
}

absl::StatusOr<Mesh> model_mesh_of_file(const schema::ResolvedSweep& sweep, const Assets& assets) {
  auto placed = placed_mesh(sweep, assets);
  if (!placed.ok()) return placed;
  std::vector<CutVertex> made;
  auto mesh = cut(*std::move(placed), sweep.sweep(), made);
  if (!mesh.ok()) return mesh;
  schema::ResolvedSweep plain = sweep;
  schema::Model& model = *plain.mutable_sweep()->mutable_model();
  if (!model.has_generate()) {
    model.set_unit_m(1);
    model.set_forward_axis("+x");
    model.set_up_axis("+z");
    model.set_reference("origin");
  }
  auto of_file = mesh_as_it_is(plain, assets);
  if (!of_file.ok()) return of_file;
  mesh->vertex = std::move(of_file->vertex);
  add_cut_vertices(made, mesh->vertex);
  return mesh;
}

}  // namespace irsig
