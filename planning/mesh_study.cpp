#include "planning/mesh_study.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/accuracy/cost_model.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/scene/import/model_file.h"
#include "core/scene/mesh_measure.h"
#include "core/scene/trace/target.h"
#include "jobs/keys/expand.h"
#include "runner/heat_outputs.h"
#include "runner/job_runner.h"
#include "runner/spec_to_request.h"

namespace irsig {
namespace {

// A mesh as the list names it.
struct AskedMesh {
  std::string name;
  std::uint64_t triangles = 0;  // of the generator
  std::string file_bytes;       // else
};

absl::Status wrong(const std::string& mesh, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("--meshes ", mesh, ": ", what));
}

absl::StatusOr<AskedMesh> generated(const std::string& name, const schema::Model& model) {
  double factor = 0;
  if (!absl::SimpleAtod(name, &factor))
    return wrong(name, absl::StrCat("the model of the sweep is generated (", model.generate(),
                                    "), expected factors on its ", model.triangles(),
                                    " triangles, e.g. 0.5,1,2"));
  // The generator says how many triangles it can make, of any number that it is asked for.
  constexpr double kMost = 1e15;
  if (!(factor > 0) || !std::isfinite(factor))
    return wrong(name, "expected a positive factor on the triangles of the sweep's model");
  const double triangles = std::min(factor * static_cast<double>(model.triangles()), kMost);
  return AskedMesh{name, static_cast<std::uint64_t>(std::llround(triangles)), ""};
}

absl::StatusOr<AskedMesh> from_file(const std::string& name, const schema::Model& model) {
  double factor = 0;
  if (absl::SimpleAtod(name, &factor))
    return wrong(name, absl::StrCat("the model of the sweep is a file (", model.file(),
                                    "), which has the facets that it has; expected mesh files of "
                                    "different densities, e.g. coarse.obj,fine.obj"));
  auto bytes = read_model_file(name, kMostModelBytes);
  if (!bytes.ok()) return wrong(name, bytes.status().message());
  return AskedMesh{name, 0, *std::move(bytes)};
}

absl::StatusOr<std::vector<AskedMesh>> asked_meshes(const std::string& list,
                                                    const schema::Model& model) {
  const std::vector<std::string> names = absl::StrSplit(list, ',');
  if (names.size() < 2) return wrong(list, "expected two or more, separated by commas");
  std::vector<AskedMesh> out;
  for (const std::string& name : names) {
    if (name.empty())
      return wrong(list, "a name is empty, expected factors or files, separated by commas");
    ASSIGN_OR_RETURN(auto mesh,
                     model.has_generate() ? generated(name, model) : from_file(name, model));
    for (const AskedMesh& other : out)
      if (other.triangles == mesh.triangles && other.file_bytes == mesh.file_bytes)
        return wrong(name, absl::StrCat("is the same mesh as ", other.name,
                                        ", expected meshes of different densities"));
    out.push_back(std::move(mesh));
  }
  return out;
}

// The sweep as all meshes have it: nothing is left out of one that is in another.
absl::StatusOr<schema::ResolvedSweep> comparable(schema::ResolvedSweep resolved,
                                                 const std::optional<double>& relative_error) {
  for (const schema::Condition& condition : resolved.condition())
    if (condition.has_temperature_field() && !condition.temperature_field().has_heat())
      return absl::InvalidArgumentError(
          absl::StrCat("--meshes: season \"", condition.season(),
                       "\" has the temperatures of the temperature field \"",
                       condition.temperature_field().field().name(),
                       "\", which belong to the facets of one mesh: expected stated temperatures"));
  schema::Sweep& sweep = *resolved.mutable_sweep();
  schema::Accuracy& accuracy = *sweep.mutable_accuracy();
  if (relative_error) {
    accuracy.clear_target_paths();
    accuracy.clear_samples_per_replicate();
    accuracy.clear_time_budget_s();
    accuracy.set_relative_error(*relative_error);
    accuracy.set_absolute_error_k(0);
  }
  if (accuracy.has_time_budget_s())
    return absl::InvalidArgumentError(
        "accuracy: the sweep asks for a time, not for an error: expected --relative-error as well");
  if (sweep.effects().mode() != "only") sweep.mutable_effects()->set_mode("all");
  sweep.mutable_output()->set_thumbnail_px(0);
  sweep.clear_profile();
  sweep.clear_published();
  return resolved;
}

void take(const AskedMesh& mesh, schema::ResolvedSweep& resolved) {
  schema::Model& model = *resolved.mutable_sweep()->mutable_model();
  if (model.has_generate()) {
    model.set_triangles(mesh.triangles);
    return;
  }
  model.set_file(mesh.name);
  resolved.set_model_file_name(mesh.name.substr(mesh.name.find_last_of('/') + 1));
  resolved.set_model_sha256(sha256_hex(mesh.file_bytes));
}

// A silhouette that fills its mask scatters nothing: known to a path's worth at best.
MeshValue area_of(const schema::Estimate& area, std::uint64_t target_paths) {
  const double paths = static_cast<double>(std::max<std::uint64_t>(target_paths, 1));
  return {area.value(), std::hypot(area.stderr(), area.value() / paths)};
}

// Returns the files of a sweep with another mesh: its model and what the sweep itself has, as land.
Assets assets_with(const AskedMesh& mesh, const schema::ResolvedSweep& sweep, Assets of_sweep) {
  if (!sweep.model_sha256().empty()) of_sweep[sweep.model_sha256()] = mesh.file_bytes;
  return of_sweep;
}

// Returns the facts of a mesh that are known before any ray is traced. `sweep` is that of the mesh.
absl::StatusOr<MeasuredMesh> looked_at(const AskedMesh& asked, const schema::ResolvedSweep& sweep,
                                       const Assets& of_sweep) {
  ASSIGN_OR_RETURN(const auto scene,
                   scene_from_sweep(sweep, assets_with(asked, sweep, of_sweep), {}));
  if (auto parts = part_of_groups(scene.mesh, scene.part); !parts.ok()) return parts.status();
  MeasuredMesh out;
  out.name = asked.name;
  out.asked_triangles = asked.triangles;
  out.facets = scene.mesh.triangle.size();
  out.surface_area_m2 = measure(scene.mesh).area_m2;
  return out;
}

absl::Status trace(const AskedMesh& asked, const schema::ResolvedSweep& sweep,
                   const Assets& of_sweep, const ChosenRows& rows,
                   const std::vector<std::uint64_t>& views, const CpuClock& cpu_s,
                   MeasuredMesh& out) {
  const double start_s = cpu_s();
  const Assets assets = assets_with(asked, sweep, of_sweep);
  ASSIGN_OR_RETURN(const auto heat, heat_outputs(sweep, assets));
  ASSIGN_OR_RETURN(const auto runner, JobRunner::create(sweep, assets, heat));
  out.setup_cpu_s = cpu_s() - start_s;
  for (const std::uint64_t viewpoint : views) {
    schema::JobSpec job;
    schema::ViewJob& view = *job.mutable_view();
    view.set_viewpoint_index(static_cast<std::uint32_t>(viewpoint));
    view.add_condition_index(rows.condition);
    view.mutable_band_index()->Assign(rows.band.begin(), rows.band.end());
    ASSIGN_OR_RETURN(const auto result, runner->run(job));
    MeshView& seen = out.view.emplace_back();
    seen.samples = static_cast<double>(result.samples());
    seen.cpu_s = result.seconds();
    for (const schema::SignatureRow& row : result.view().row()) {
      // The silhouette's area is the same in all bands.
      seen.projected_area_m2 = area_of(row.projected_area_m2(), result.target_paths());
      seen.intensity_w_sr.push_back({row.intensity_w_sr().value(), row.numerical_error_w_sr()});
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<MeshComparison> compare_meshes(
    const LoadedSweep& loaded, const MeshStudyAsked& asked, const CpuClock& cpu_s,
    const std::function<void(const MeasuredMesh&)>& seen) {
  ASSIGN_OR_RETURN(const auto rows, choose_rows(loaded.resolved, asked.rows));
  ASSIGN_OR_RETURN(const auto meshes, asked_meshes(asked.meshes, loaded.resolved.sweep().model()));
  ASSIGN_OR_RETURN(auto sweep, comparable(loaded.resolved, asked.relative_error));
  std::vector<std::uint64_t> views =
      spread_views(static_cast<std::uint64_t>(sweep.viewpoint_size()), asked.views);
  std::sort(views.begin(), views.end());

  MeshComparison out;
  out.sweep = sweep.sweep().name();
  const schema::Condition& condition = sweep.condition(static_cast<int>(rows.condition));
  out.season = condition.season();
  out.time_utc = condition.time_utc();
  for (const std::uint32_t band : rows.band)
    out.band.push_back(sweep.sweep().band(static_cast<int>(band)).name());
  for (const std::uint64_t view : views) {
    const schema::Viewpoint& v = sweep.viewpoint(static_cast<int>(view));
    out.viewpoint.push_back({v.aspect_azimuth_deg(), v.aspect_elevation_deg(), v.range_m()});
  }
  const auto of = [](const AskedMesh& mesh, const absl::Status& status) {
    return absl::Status(status.code(),
                        absl::StrCat("--meshes ", mesh.name, ": ", status.message()));
  };
  for (const AskedMesh& mesh : meshes) {
    take(mesh, sweep);
    auto looked = looked_at(mesh, sweep, loaded.assets);
    if (!looked.ok()) return of(mesh, looked.status());
    for (const MeasuredMesh& other : out.mesh)
      if (sweep.sweep().model().has_generate() && other.facets == looked->facets)
        return wrong(mesh.name, absl::StrCat("makes the same ", looked->facets, " facets as ",
                                             other.name, ", expected different densities"));
    out.mesh.push_back(*std::move(looked));
  }
  for (std::size_t i = 0; i < out.mesh.size(); ++i) {
    const AskedMesh& mesh = meshes[i];
    take(mesh, sweep);
    if (auto status = trace(mesh, sweep, loaded.assets, rows, views, cpu_s, out.mesh[i]);
        !status.ok())
      return of(mesh, status);
    seen(out.mesh[i]);
  }
  std::stable_sort(
      out.mesh.begin(), out.mesh.end(),
      [](const MeasuredMesh& a, const MeasuredMesh& b) { return a.facets < b.facets; });
  return out;
}

}  // namespace irsig
