// Rationale: meshes as other programs write them. Each file stands for a kind that was once refused
// or read wrongly; what it has to give is its area by hand, or the words that say what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/base/user_file.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/import/model_file.h"
#include "core/scene/mesh.h"
#include "core/scene/mesh_measure.h"
#include "tests/unit/float32_files.h"
#include "tests/unit/test_folder.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<Mesh> foreign_mesh(const std::string& name, const std::string& bytes) {
  return import_mesh(bytes, {name, 1, "+x", "+z", "origin"});
}

double foreign_area_m2(const std::string& name, const std::string& bytes, std::size_t facets) {
  const absl::StatusOr<Mesh> mesh = foreign_mesh(name, bytes);
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  if (!mesh.ok()) return 0;
  EXPECT_EQ(mesh->triangle.size(), facets);
  return measure(*mesh).area_m2;
}

std::string words_about(const std::string& name, const std::string& bytes) {
  return std::string(foreign_mesh(name, bytes).status().message());
}

// A box of 2 x 1 x 1 (10 m2): its corners, and its faces with corners counted from 0.
constexpr int kBox[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                            {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
std::array<float, 3> box_corner(int i) {
  return {(i & 1) != 0 ? 2.F : 0.F, (i & 2) != 0 ? 0.5F : -0.5F, (i & 4) != 0 ? 0.5F : -0.5F};
}

std::vector<Corners> foreign_box() {
  std::vector<Corners> out;
  for (const auto& face : kBox)
    for (const auto& three : {std::array{0, 1, 2}, std::array{0, 2, 3}})
      out.push_back(
          {box_corner(face[three[0]]), box_corner(face[three[1]]), box_corner(face[three[2]])});
  return out;
}

// Writes OBJ; `behind` stands behind each corner of a face.
std::string box_obj(const std::string& behind = "", const std::string& line_end = "\n") {
  std::string out;
  for (int i = 0; i < 8; ++i) {
    const auto [x, y, z] = box_corner(i);
    out += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + line_end;
  }
  for (const auto& face : kBox) {
    out += "f";
    for (const int i : face) out += " " + std::to_string(i + 1) + behind;
    out += line_end;
  }
  return out;
}

std::string box_stl(const std::string& normal = "0 0 1", bool closed = true) {
  std::string out = "solid box\n";
  for (const Corners& facet : foreign_box()) {
    out += "facet normal " + normal + "\nouter loop\n";
    for (const auto& [x, y, z] : facet)
      out +=
          "vertex " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    out += "endloop\nendfacet\n";
  }
  return closed ? out + "endsolid box\n" : out;
}

TEST(ForeignObj, EmptyPartsOfCorners) {
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", box_obj(), 12), 10);
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", box_obj("//"), 12), 10);   // "f 1// 2// 4// 3//"
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", box_obj("/1/"), 12), 10);  // "f 1/1/ 2/1/ ..."
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", box_obj("/1/1"), 12), 10);
}

TEST(ForeignObj, EndsOfTheFileAndOfLines) {
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", box_obj() + "\x1a", 12), 10);  // Ctrl-Z of DOS
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", box_obj() + std::string(3, '\0'), 12), 10);
  EXPECT_DOUBLE_EQ(
      foreign_area_m2("a.obj", "\xef\xbb\xbf# made elsewhere\r\n" + box_obj("", "\r\n"), 12), 10);
  // A line goes on behind a backslash, with and without a blank before it.
  const std::string v = "v 0 0 0\nv 2 0 0\nv 0 2 0\n";
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", v + "f 1 2 \\\n 3\n", 1), 2);
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", v + "f 1 2\\\n 3\n", 1), 2);
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", v + "f 1 2\\\r\n 3\\\r\n\n", 1), 2);
  const absl::StatusOr<Mesh> named = foreign_mesh("a.obj", v + "g hull\\\nport\nf 1 2 3\n");
  ASSERT_TRUE(named.ok()) << named.status();
  EXPECT_EQ(named->group, std::vector<std::string>{"hull/port"});
}

TEST(ForeignObj, RepeatedCornersOfPolygonsHaveNoArea) {
  const std::string v = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", v + "f 1 2 2 3 4\n", 3), 2);
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.obj", v + "f 1 2 3 4 1\n", 3), 2);
}

TEST(ForeignObj, WhatIsRefusedSaysWhatToDo) {
  // A surface says so once, however many statements it takes.
  EXPECT_EQ(words_about("a.obj", box_obj() + "cstype bspline\ndeg 3 3\nsurf 0 1 0 1 1 2\nend\n"),
            "a.obj:15:1: \"cstype\" belongs to a free-form curve or surface, which is not read: "
            "export the model as polygons");
  EXPECT_THAT(words_about("a.obj", "v 0 0,5 0\n"),
              HasSubstr("a.obj:1:5: \"0,5\" is not a number that a double can hold: export the "
                        "model with decimal points"));
  EXPECT_THAT(words_about("a.obj", "version https://git-lfs.github.com/spec/v1\n"),
              HasSubstr("a.obj: this is a pointer of Git LFS, not the model"));
}

TEST(ForeignStl, BinaryFiles) {
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.stl", binary_stl(foreign_box(), "solid box\n"), 12), 10);
  // A byte behind the last facet, as an editor of text leaves it.
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.stl", binary_stl(foreign_box(), "solid box") + "\n", 12), 10);
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.stl", binary_stl(foreign_box(), "\xef\xbb\xbfsolid"), 12),
                   10);
}

TEST(ForeignStl, Texts) {
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.stl", "\xef\xbb\xbf\n " + box_stl(), 12), 10);
  for (const char* normal : {"nan nan nan", "-nan(ind) 0 1", "1.#QNAN -1.#IND 0"})
    EXPECT_DOUBLE_EQ(foreign_area_m2("a.stl", box_stl(normal), 12), 10) << normal;
  EXPECT_THAT(words_about("a.stl", box_stl("0 1")),
              HasSubstr("a.stl:3:1: \"outer\", expected a number of the normal"));
  EXPECT_THAT(words_about("a.stl", box_stl("0 0 1", false)),
              HasSubstr("the file ends without \"endsolid\": it may be cut short"));
  EXPECT_THAT(
      words_about("a.stl", "# by hand\n" + box_stl()),
      HasSubstr("this is text that begins with \"#\", and ASCII STL begins with \"solid\""));
}

// A sliver of 0.2 mm on a box of 100 x 40 x 40 m, where float32 is 8 um apart: both encodings have
// 19200 m2.
TEST(ForeignStl, ASliverInALargeModel) {
  std::vector<Corners> facets;
  for (Corners facet : foreign_box()) {
    for (auto& corner : facet) corner = {corner[0] * 50, corner[1] * 40 - 20, corner[2] * 40 + 20};
    facets.push_back(facet);
  }
  facets.push_back({{{33.3332F, 0, 13}, {33.3334F, 0, 13}, {33.3333F, 0, 13.0001F}}});
  EXPECT_NEAR(foreign_area_m2("a.stl", binary_stl(facets), 13), 19200, 1e-3);
}

TEST(ForeignPly, WordsThatAreNoNumbersWhereNoneIsNeeded) {
  const std::string text =
      "ply\nformat ascii 1.0\ncomment a\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty uchar red\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
      "0 0 0 nan 255\n2 0 0 1.#QNAN 255\n0 2 0 -1.#IND 0\n3 0 1 2 6 0 0 1 0 1 1\n";
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.ply", text, 1), 2);
  std::string wrong = text;
  wrong.replace(wrong.find("1.#QNAN"), 7, "red");
  EXPECT_THAT(words_about("a.ply", wrong), HasSubstr("a.ply:15:7: this is not a number"));
}

// Faces before vertices, lists of colours between, big endian, 16-bit numbers.
TEST(ForeignPly, BinaryInAnyOrder) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement face 1\nproperty uchar flags\n"
      "property list ushort ushort vertex_index\nelement material 1\n"
      "property list uchar uchar name\nelement vertex 3\nproperty short x\nproperty short y\n"
      "property double z\nproperty uchar alpha\nend_header\n";
  const auto put = [&](auto value) {
    std::string one;
    append_bytes(value, one);
    bytes.append(one.rbegin(), one.rend());
  };
  bytes += '\1';
  for (const int i : {3, 0, 1, 2}) put(static_cast<std::uint16_t>(i));
  bytes += "\3abc";
  for (const auto& [x, y] : {std::pair{0, 0}, std::pair{-2, 0}, std::pair{0, -2}}) {
    put(static_cast<std::int16_t>(x));
    put(static_cast<std::int16_t>(y));
    put(0.25);
    bytes += '\xff';
  }
  EXPECT_DOUBLE_EQ(foreign_area_m2("a.ply", bytes, 1), 2);
}

// Tests the message for a .gltf whose buffer is in another place.
TEST(ForeignGltf, ABufferThatIsNotThere) {
  const TestFolder folder;
  const auto said = [&](const std::string& uri) {
    std::ofstream(folder.file("a.gltf"))
        << R"({"asset":{"version":"2.0"},"buffers":[{"uri":")" + uri + R"(","byteLength":4}]})";
    return std::string(read_model_file(folder.file("a.gltf"), kMostModelBytes).status().message());
  };
  EXPECT_THAT(said("van.bin"), HasSubstr("buffers[0].uri \"van.bin\": no such file, expected it "
                                         "beside the .gltf: copy it there, or export a .glb"));
  EXPECT_THAT(said("parts\\\\van.bin"), HasSubstr("has a backslash, expected \"/\""));
}

}  // namespace
}  // namespace irsig
