// Sweeps, goniometers, meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/scene/import/import_mesh.h"
#include "core/scene/mesh.h"
#include "jobs/check_resolved.h"
#include "jobs/goniometer_file.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_sweep.h"
#include "jobs/text/sweep_file.h"
#include "tests/fuzz/mesh_mutants.h"
#include "tests/fuzz/readers.h"

namespace irsig::fuzz {
namespace {

// Read or refused with a place; a sweep that resolves has finite numbers and jobs with keys.
bool accepts_sweep(const std::string& text) {
  const absl::StatusOr<SweepFile> file = parse_sweep(text, "f.toml");
  if (!file.ok()) return refused(file.status(), "f.toml");
  const absl::StatusOr<schema::ResolvedSweep> sweep = resolve_sweep(*file, "v");
  if (!sweep.ok()) return refused(sweep.status(), "f.toml");
  // A sweep that a file can state can be submitted.
  EXPECT_TRUE(check_resolved(*sweep).ok()) << check_resolved(*sweep);
  EXPECT_GT(sweep->viewpoint_size(), 0);
  EXPECT_GT(sweep->condition_size(), 0);
  for (const schema::Condition& condition : sweep->condition()) {
    EXPECT_EQ(condition.part_temperature_k_size(), sweep->sweep().part_size());
    for (const double t : condition.part_temperature_k()) EXPECT_TRUE(std::isfinite(t));
  }
  if (sweep->viewpoint_size() < 300) {
    EXPECT_GE(expand_jobs(*sweep, 1).size(), static_cast<std::size_t>(sweep->viewpoint_size()));
  }
  return true;
}

// Examples, and files that are wrong in one way each.
std::vector<std::string> sweeps() {
  std::vector<std::filesystem::path> paths;
  for (const char* folder : {"jobs/examples", "tests/unit/bad_sweeps"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             std::filesystem::path(IRSIG_SOURCE_DIR) / folder))
      if (entry.path().extension() == ".toml" &&
          entry.path().parent_path().filename() != "detectors")
        paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> texts;
  for (const auto& path : paths) {
    std::ifstream in(path, std::ios::binary);
    texts.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return texts;
}

bool accepts_goniometer(const std::string& text) {
  const auto file = parse_goniometer(text, "g.toml");
  if (!file.ok()) return refused(file.status(), "g.toml");
  const auto resolved = resolve_goniometer(*file, "");
  return resolved.ok() || refused(resolved.status(), "g.toml");
}

}  // namespace

bool accepts_mesh(const std::string& bytes, const std::string& name, const std::string& reference) {
  MeshImport how;
  how.file_name = name;
  how.reference = reference;
  const absl::StatusOr<Mesh> mesh = import_mesh(bytes, how);
  if (!mesh.ok()) return refused(mesh.status(), name, Says::kFile);
  EXPECT_EQ(mesh->triangle.size(), mesh->triangle_group.size());
  EXPECT_FALSE(mesh->triangle.empty());
  for (const auto& t : mesh->triangle)
    for (const std::uint32_t index : t) EXPECT_LT(index, mesh->vertex.size());
  for (const std::uint32_t group : mesh->triangle_group) EXPECT_LT(group, mesh->group.size());
  for (const Vec<Body>& v : mesh->vertex)
    EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
  return true;
}

std::vector<Reader> scene_readers() {
  const auto mesh = [](const char* name) {
    return [name](const std::string& text) {
      return accepts_mesh(text, name, text.size() % 2 == 0 ? "origin" : "bbox_bottom_center");
    };
  };
  const std::vector<const char*> mesh_words(std::begin(kMeshWords), std::end(kMeshWords));
  return {
      // Mutated by tests/fuzz/sweep_file_fuzz.cpp.
      {"sweep", sweeps(), {"nan", "[[part]]\n", "= 1e999\n"}, accepts_sweep, 100},
      {"goniometer",
       {"name = \"test\"\n[particles]\nwidth_m = 0.02\ncoverage = [0.5]\n"
        "size = [{diameter_m = 0.001}]\n[[material]]\nname = \"soil\"\nkind = \"lambert\"\n"
        "emissivity = 0.6\n[[part]]\nname = \"soil\"\nmatch = [\"grain_*\"]\nmaterial = \"soil\"\n"
        "[[part]]\nname = \"plate\"\nmaterial = \"soil\"\n[[band]]\nname = \"green\"\n"
        "center_um = 0.55\nfwhm_um = 0.04\n[source]\nzenith_deg = [0, 30]\n[sensor]\n"
        "field_width_m = 0.01\n[view]\nzenith_max_deg = 80\nzenith_step_deg = 40\n"
        "azimuth_step_deg = 90\n[accuracy]\nsamples_per_replicate = 64\n"},
       {"nan", "1e999", "-", ",", "= ", "\"", "{", "[", "]\n[", "-inf", "#", "true"},
       accepts_goniometer},
      {"obj",
       {"o a\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 1 1 3\nvn 0 0 1\nusemtl s\n"
        "f 1 2 3 4 5\ng b c\nf 1/1/1 -1//1 2\nf 2 6 3 # side\nf 3 6 5 4\n"},
       mesh_words,
       mesh("a.obj"),
       40000},
      {"ply",
       {"ply\nformat ascii 1.0\ncomment c\nelement vertex 5\nproperty double x\nproperty float y\n"
        "property float z\nproperty uchar red\nelement face 3\nproperty list uchar int "
        "vertex_indices\nend_header\n0 0 0 1\n4 0 0 2\n4 4 0 3\n1 1 0 4\n0 4 1 5\n5 0 1 2 3 4\n"
        "3 0 1 3\n3 1 2 4\n"},
       mesh_words,
       mesh("a.ply"),
       40000},
      {"stl",
       {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid a\nsolid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\n"
        "vertex 1 0 1\nvertex 0 1 1.5\nendloop\nendfacet\nendsolid\n"},
       mesh_words,
       mesh("a.stl"),
       40000}};
}

}  // namespace irsig::fuzz
