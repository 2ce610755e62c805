// Mutated mesh files, the same ones in every run: a reader must refuse them or return a mesh whose
// indices are in range and whose vertices are finite, whatever stands in the file. Run it with
// IRSIG_SANITIZE=address,undefined to see more; IRSIG_FUZZ_RUNS multiplies the number of files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/scene/mesh.h"
#include "tests/fuzz/mutator.h"
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

constexpr const char* kWords[] = {" ",
                                  "\n",
                                  " -1 ",
                                  " 0 ",
                                  "nan",
                                  "1e308 ",
                                  "-1e-320 ",
                                  "/",
                                  "//",
                                  " 4294967296 ",
                                  " 99999999999999999999 ",
                                  "\\\n",
                                  "f ",
                                  "v ",
                                  "o ",
                                  "\nf 1 2 3 4 5 6 7 8 9 10\n",
                                  "list ",
                                  "vertex ",
                                  "facet "};

int runs(int count) {
  const char* factor = std::getenv("IRSIG_FUZZ_RUNS");
  return factor == nullptr ? count : count * std::atoi(factor);
}

void fuzz(const std::string& name, const std::string& text, int count, std::uint64_t seed) {
  fuzz::Mutator mutator(seed, kWords);
  int accepted = 0, refused = 0;
  for (int i = 0; i < runs(count); ++i) {
    const std::string mutant = mutator.mutate(text);
    MeshImport how;
    how.file_name = name;
    how.reference = i % 2 == 0 ? "origin" : "bbox_bottom_center";
    const absl::StatusOr<Mesh> mesh = import_mesh(mutant, how);
    if (mesh.ok()) {
      ++accepted;
      ASSERT_NO_FATAL_FAILURE(expect_sound(*mesh)) << mutant;
    } else {
      ++refused;
      ASSERT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument) << mutant;
      ASSERT_EQ(std::string(mesh.status().message()).substr(0, name.size()), name) << mutant;
    }
  }
  // Mutants that are all refused at their first word would test nothing.
  EXPECT_GT(accepted, count / 50) << name;
  EXPECT_GT(refused, count / 50) << name;
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
TEST(MeshReaders, BinaryStl) { fuzz("a.stl", binary_stl(kFacets), 4000, 4); }
TEST(MeshReaders, BinaryPly) { fuzz("a.ply", binary_ply(kFacets), 4000, 5); }
// Assimp fills what a false count asks for before it looks further: 5 ms a file.
TEST(MeshReaders, Glb) { fuzz("a.glb", glb(kFacets), 400, 6); }

}  // namespace
}  // namespace irsig
