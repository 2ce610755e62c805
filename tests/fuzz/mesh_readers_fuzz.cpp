// Mutated mesh files, the same ones in every run: a reader must refuse them or return a mesh whose
// indices are in range and whose vertices are finite, whatever stands in the file. Run it with
// IRSIG_SANITIZE=address,undefined to see more.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/scene/import_reply.h"
#include "core/scene/mesh.h"
#include "tests/fuzz/mesh_mutants.h"
#include "tests/fuzz/turns.h"
#include "tests/unit/float32_files.h"

namespace irsig {
namespace {

void expect_sound(const Mesh& mesh) {
  ASSERT_EQ(mesh.triangle.size(), mesh.triangle_group.size());
  ASSERT_FALSE(mesh.triangle.empty());
  for (const auto& t : mesh.triangle)
    for (const std::uint32_t index : t) ASSERT_LT(index, mesh.vertex.size());
  for (const std::uint32_t group : mesh.triangle_group) ASSERT_LT(group, mesh.group.size());
  for (const Vec<Body>& v : mesh.vertex)
    ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
}

void fuzz(const std::string& name, int count, const std::function<std::string()>& next) {
  int accepted = 0, refused = 0;
  for (fuzz::Turns turn(count); turn.next();) {
    const std::string mutant = next();
    MeshImport how;
    how.file_name = name;
    how.reference = turn.index() % 2 == 0 ? "origin" : "bbox_bottom_center";
    const absl::StatusOr<Mesh> mesh = import_mesh(mutant, how);
    if (mesh.ok()) {
      ++accepted;
      ASSERT_NO_FATAL_FAILURE(expect_sound(*mesh)) << mutant;
    } else {
      ++refused;
      ASSERT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument)
          << mesh.status() << mutant;
      ASSERT_EQ(std::string(mesh.status().message()).substr(0, name.size()), name) << mutant;
    }
  }
  // Mutants that are all refused at their first word would test nothing.
  EXPECT_GT(accepted, count / 50) << name;
  EXPECT_GT(refused, count / 50) << name;
}

void fuzz(const std::string& name, const std::string& text, int count, std::uint64_t seed) {
  fuzz::Mutator mutator(seed, fuzz::kMeshWords);
  fuzz(name, count, [&] { return mutator.mutate(text); });
}

const char* const kObj =
    "o a\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 1 1 3\nvn 0 0 1\nusemtl s\n"
    "f 1 2 3 4 5\ng b c\nf 1/1/1 -1//1 2\nf 2 6 3 # side\nf 3 6 5 4\n";

const char* const kPly =
    "ply\nformat ascii 1.0\ncomment c\nelement vertex 5\nproperty double x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 3\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0 1\n4 0 0 2\n4 4 0 3\n1 1 0 4\n0 4 1 5\n5 0 1 2 3 4\n3 0 1 3\n3 1 2 4\n";

const char* const kStl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    "endfacet\nendsolid a\nsolid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 1\n"
    "vertex 0 1 1.5\nendloop\nendfacet\nendsolid\n";

const std::vector<Corners> kFacets = {{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
                                      {{{0, 0, 0}, {0, 4, 0}, {0, 0, 4}}}};

TEST(MeshReaders, Obj) { fuzz("a.obj", kObj, 40000, 1); }
TEST(MeshReaders, AsciiPly) { fuzz("a.ply", kPly, 40000, 2); }
TEST(MeshReaders, AsciiStl) { fuzz("a.stl", kStl, 40000, 3); }
// Each of these starts a process: 10 ms. Some of the glTF and GLB files crash Assimp.
TEST(MeshReaders, BinaryStl) { fuzz("a.stl", binary_stl(kFacets), 200, 4); }
TEST(MeshReaders, BinaryPly) { fuzz("a.ply", binary_ply(kFacets), 200, 5); }
TEST(MeshReaders, Gltf) {
  fuzz::GltfMutator mutator(false, 7);
  fuzz("a.gltf", 250, [&] { return mutator.next(); });
}
TEST(MeshReaders, Glb) {
  fuzz::GltfMutator mutator(true, 7);
  fuzz("a.glb", 250, [&] { return mutator.next(); });
}

// What the other process says is believed only where it makes sense.
TEST(MeshReaders, Reply) {
  FileMesh mesh;
  mesh.vertex = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangle = {{0, 1, 2}, {1, 2, 3}};
  mesh.triangle_group = {0, 1};
  mesh.group = {"hull", ""};
  const std::string reply = encode_reply(mesh);
  fuzz::Mutator mutator(8, fuzz::kMeshWords);
  int accepted = 0;
  for (fuzz::Turns turn(20000); turn.next();) {
    const absl::StatusOr<FileMesh> read = decode_reply(mutator.mutate(reply));
    if (!read.ok()) continue;
    ++accepted;
    Mesh sound;
    for (const Vec<FileFrame>& v : read->vertex) sound.vertex.push_back({v.x, v.y, v.z});
    sound.triangle = read->triangle;
    sound.triangle_group = read->triangle_group;
    sound.group = read->group;
    if (sound.triangle.empty()) continue;
    ASSERT_NO_FATAL_FAILURE(expect_sound(sound));
  }
  EXPECT_GT(accepted, 400);
}

}  // namespace
}  // namespace irsig
