// Mutated mesh files that a process of its own reads, the same ones in every run: a reader must
// refuse them or return a mesh whose indices are in range and whose vertices are finite, whatever
// stands in the file. Run it with IRSIG_SANITIZE=address,undefined to see more.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/scene/import/import_reply.h"
#include "core/scene/mesh.h"
#include "tests/fuzz/mesh_mutants.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/turns.h"
#include "tests/unit/float32_files.h"

namespace irsig {
namespace {

void fuzz(const std::string& name, int count, const std::function<std::string()>& next) {
  int accepted = 0, tried = 0;
  for (fuzz::Turns turn(count); turn.next(); ++tried) {
    const std::string mutant = next();
    accepted +=
        fuzz::accepts_mesh(mutant, name, turn.index() % 2 == 0 ? "origin" : "bbox_bottom_center")
            ? 1
            : 0;
    ASSERT_FALSE(testing::Test::HasFailure()) << mutant;
  }
  // Mutants that are all refused at their first word would test nothing.
  EXPECT_GT(accepted, count / 50) << name;
  EXPECT_LT(accepted, tried - count / 50) << name;
}

void fuzz(const std::string& name, const std::string& text, int count, std::uint64_t seed) {
  fuzz::Mutator mutator(seed, fuzz::kMeshWords);
  fuzz(name, count, [&] { return mutator.mutate(text); });
}

const std::vector<Corners> kFacets = {{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
                                      {{{0, 0, 0}, {0, 4, 0}, {0, 0, 4}}}};

// Each glTF and GLB file starts a process: 10 ms.
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

// A reply of the other process counts only where it makes sense.
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
    for (const auto& t : read->triangle)
      for (const std::uint32_t index : t) ASSERT_LT(index, read->vertex.size());
    ASSERT_EQ(read->triangle.size(), read->triangle_group.size());
    for (const std::uint32_t group : read->triangle_group) ASSERT_LT(group, read->group.size());
    for (const Vec<FileFrame>& v : read->vertex)
      ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
  }
  EXPECT_GT(accepted, 400);
}

}  // namespace
}  // namespace irsig
