#include "core/scene/generate/generate_mesh.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <tuple>

#include "core/scene/mesh_measure.h"
#include "core/scene/trace/target.h"
#include "tests/unit/float32_files.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Mesh read(const std::string& name, const std::string& bytes, MeshImport how = {}) {
  how.file_name = name;
  absl::StatusOr<Mesh> mesh = import_mesh(bytes, how);
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return mesh.ok() ? *std::move(mesh) : Mesh{};
}

// Returns the message for a file that is refused; every refusal is the user's.
std::string refusal(const std::string& name, const std::string& bytes, MeshImport how = {}) {
  how.file_name = name;
  const absl::StatusOr<Mesh> mesh = import_mesh(bytes, how);
  EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument);
  return std::string(mesh.status().message());
}

const std::string kTetrahedronObj =
    "# a comment\n"
    "mtllib none.mtl\n"
    "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\n"
    "vn 0 0 1\nvt 0 0\n"
    "o tetra\n"
    "f 1 3 2\n"
    "f 1/1 2/1 4/1\n"
    "g side slant\nusemtl wet steel\n"
    "f 1//1 4//1 3//1\n"
    "f -3/1/1 -2/1/1 \\\n -1/1/1\n";

TEST(ObjImport, ReadsCornersGroupsAndNegativeNumbers) {
  const Mesh mesh = read("a.obj", kTetrahedronObj);
  ASSERT_EQ(mesh.vertex.size(), 4u);
  ASSERT_EQ(mesh.triangle.size(), 4u);
  EXPECT_THAT(mesh.group, ElementsAre("tetra", "tetra/side/slant/wet steel"));
  EXPECT_THAT(mesh.triangle_group, ElementsAre(0, 0, 1, 1));
  const MeshMeasure m = measure(mesh);
  EXPECT_EQ(m.open_edges, 0u);
  EXPECT_DOUBLE_EQ(m.volume_m3, 4);  // outward: the frame's change must not turn it inside out
  EXPECT_EQ(mesh.degenerate_triangles, 0u);
}

TEST(ObjImport, AnEarlierFaceMayNameALaterVertex) {
  EXPECT_EQ(read("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").triangle.size(), 1u);
}

// Single precision has no areas for the one and no digits between the corners of the other.
// As other programs write them.
TEST(ObjImport, EmptyPartsOfCornersColoursAndLineEnds) {
  const auto area = [](const std::string& text) { return measure(read("a.obj", text)).area_m2; };
  const std::string v = "v 0 0 0\nv 2 0 0\nv 0 2 0\n";
  EXPECT_DOUBLE_EQ(area(v + "f 1// 2// 3//\n"), 2);
  EXPECT_DOUBLE_EQ(area(v + "f 1/1/ 2/2/ 3/\n"), 2);
  EXPECT_DOUBLE_EQ(area("v 0 0 0 nan nan nan\nv 2 0 0 1 -nan(ind) 0\nv 0 2 0 1.#QNAN 0 0\nf 1 2 3\n"),
                   2);
  EXPECT_DOUBLE_EQ(area("\xef\xbb\xbf# made elsewhere\rv 0 0 0\rv 2 0 0\rv 0 2 0\rf 1 2 3\r"), 2);
  EXPECT_DOUBLE_EQ(area("v 0 0 0\r\nv 2 0 0\r\nv 0 2 0\r\nf 1 2 \\\r\n 3\r\n"), 2);
  EXPECT_THAT(refusal("a.obj", std::string("\xff\xfev\0", 4)), HasSubstr("UTF-16"));
}

TEST(ObjImport, SizesThatNoModelHasAreRefused) {
  const auto triangle = [](const char* size) {
    return std::string("v 0 0 0\nv ") + size + " 0 0\nv 0 " + size + " 0\nf 1 2 3\n";
  };
  for (const char* size : {"1e30", "1e150", "1e7", "1e-7", "1e-30", "1e-300"})
    EXPECT_THAT(refusal("a.obj", triangle(size)),
                HasSubstr("expected 1e-06 to 1000000 m: is unit_m right?"))
        << size;
  for (const char* size : {"1e-6", "1", "7e5"})
    EXPECT_EQ(read("a.obj", triangle(size)).triangle.size(), 1u) << size;
  MeshImport millimetres;
  millimetres.unit_m = 0.001;
  EXPECT_THAT(refusal("a.obj", triangle("1e10"), millimetres),
              HasSubstr("a.obj: the mesh is 1.41421e+07 m across (1.41421e+10 in the file's unit, "
                        "which is 0.001 m)"));
}

TEST(ObjImport, ErrorsSayWhere) {
  EXPECT_THAT(refusal("s/a.obj", "v 0 0 0\nv 1 0\n"), HasSubstr("s/a.obj:2:1: a vertex with 2"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 zero\n"), HasSubstr("a.obj:1:7: \"zero\" is not a number"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 1e999\n"), HasSubstr("a.obj:1:7: "));
  EXPECT_THAT(refusal("a.obj", "v 0 nan 0\n"),
              HasSubstr("a.obj:1:5: the coordinate \"nan\" is not"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 -inf\n"), HasSubstr("a.obj:1:7: "));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 1\n"), HasSubstr("a.obj:2:1: a face with 2 corners"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 1 -2\n"), HasSubstr("a.obj:2:7: vertex -2 does not"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 1 0\n"), HasSubstr("a.obj:2:7: vertex 0 does not"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 1 5\n"), HasSubstr("a.obj:2:7: vertex 5 does not"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 1 1/2/3/4\n"), HasSubstr("a.obj:2:7: \"1/2/3/4\""));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 1 1/x\n"), HasSubstr("a.obj:2:7: \"1/x\""));
  EXPECT_THAT(refusal("a.obj", "surf 0 1\n"), HasSubstr("a.obj:1:1: \"surf\" belongs to a free-form"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\n"), HasSubstr("a.obj: the mesh is empty"));
  EXPECT_THAT(refusal("a.obj", ""), HasSubstr("a.obj: the file is empty"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n"), HasSubstr("has an area"));
}

TEST(ObjImport, ReportsAllMistakesUpToTen) {
  const std::string two = refusal("a.obj", "v 0 0\nv 1 2 x\nf 1 2\n");
  EXPECT_THAT(two, HasSubstr("a.obj:1:1"));
  EXPECT_THAT(two, HasSubstr("a.obj:2:7"));
  EXPECT_THAT(two, HasSubstr("a.obj:3:1"));
  std::string bad;
  for (int i = 0; i < 100; ++i) bad += "oops\n";
  const std::string text = refusal("a.obj", bad);
  EXPECT_THAT(text, HasSubstr("a.obj:10:1"));
  EXPECT_THAT(text, HasSubstr("too many errors"));
  EXPECT_THAT(text, Not(HasSubstr("a.obj:11:1")));
}

double area_m2(const Mesh& mesh) { return measure(mesh).area_m2; }

TEST(Polygons, ConcaveOnesAreCutAndNotFanned) {
  // An arrow head, an L far from the origin and tilted, a comb: a fan would cover too much.
  EXPECT_DOUBLE_EQ(area_m2(read("a.obj", "v 0 0 0\nv 4 2 0\nv 0 4 0\nv 1 2 0\nf 1 2 3 4\n")), 6);
  const std::string corner_l =
      "v 1e6 0 0\nv 1000002 0 0\nv 1000002 1 1\nv 1000001 1 1\nv 1000001 2 2\nv 1e6 2 2\n"
      "f 4 5 6 1 2 3\n";
  MeshImport centred;
  centred.reference = "bbox_center";
  EXPECT_NEAR(area_m2(read("a.obj", corner_l, centred)), 3 * std::sqrt(2.0), 1e-12);
  std::string comb, face = "f";
  int corners = 0;
  const auto corner = [&](double x, double y) {
    comb += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
    face += " " + std::to_string(++corners);
  };
  corner(0, 0);
  for (int tooth = 0; tooth < 8; ++tooth) {
    corner(2 * tooth, 3);
    corner(2 * tooth + 1, 3);
    corner(2 * tooth + 1, 1);
    corner(2 * tooth + 2, 1);
  }
  corner(16, 0);
  const Mesh mesh = read("a.obj", comb + face + "\n");
  EXPECT_EQ(mesh.triangle.size(), static_cast<std::size_t>(corners - 2));
  EXPECT_NEAR(area_m2(mesh), 32.0, 1e-12);
}

TEST(Polygons, CornersInALineAreKeptAndCounted) {
  const Mesh mesh = read("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n");
  EXPECT_EQ(mesh.triangle.size(), 3u);
  EXPECT_DOUBLE_EQ(area_m2(mesh), 4);
}

TEST(Polygons, CrossingOnesAreRefused) {
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1.5 0\nf 1 2 3 4\n"),
              HasSubstr("a.obj:5:1: this face cannot be cut"));
  // A five-pointed star turns left at every corner.
  std::string star;
  for (int i = 0; i < 5; ++i)
    star += "v " + std::to_string(std::cos(i * 2.513274)) + " " +
            std::to_string(std::sin(i * 2.513274)) + " 0\n";
  EXPECT_THAT(refusal("a.obj", star + "f 1 2 3 4 5\n"), HasSubstr("a.obj:6:1"));
}

TEST(Degenerate, TrianglesStayAndAreCounted) {
  const Mesh mesh =
      read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n");
  EXPECT_EQ(mesh.triangle.size(), 3u);
  EXPECT_EQ(mesh.degenerate_triangles, 2u);
}

TEST(PlyImport, AnyOrderOfPropertiesAndElements) {
  const std::string text =
      "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\n"
      "element camera 1\r\nproperty list uchar float view\r\nproperty int id\r\n"
      "element vertex 4\r\nproperty uchar red\r\nproperty double z\r\nproperty double x\r\n"
      "property float y\r\n"
      "element face 2\r\nproperty uchar flags\r\nproperty list uchar int vertex_index\r\n"
      "end_header\r\n"
      "2 0.5 0.5 7\r\n"
      "255 5 0 0\r\n255 5 1 0\r\n255 5 1 0.123456789012345678\r\n255 5 0 1\r\n"
      "0 3 0 1 2\r\n0 3 0 2 3\r\n";
  const Mesh mesh = read("A.PLY", text);
  ASSERT_EQ(mesh.triangle.size(), 2u);
  EXPECT_THAT(mesh.group, ElementsAre("default"));
  EXPECT_EQ(mesh.vertex[2], (Vec<Body>{1, -0.123456789012345678, -5}));
}

TEST(PlyImport, StripsOfTriangles) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n5 0 0\n5 1 0\n6 0 0\n";
  const Mesh mesh = read("a.ply", text + "11 1 0 3 2 5 4 -1 7 6 8 -1\n");
  ASSERT_EQ(mesh.triangle.size(), 5u);
  EXPECT_EQ(measure(mesh).area_m2, 2.5);
  for (const auto& t : mesh.triangle) {  // all face up: body z is down
    const Vec<Body> a = mesh.vertex[t[0]];
    EXPECT_LT(cross(mesh.vertex[t[1]] - a, mesh.vertex[t[2]] - a).z, 0);
  }
  EXPECT_THAT(refusal("a.ply", text + "4 0 1 -2 3\n"),
              HasSubstr("a.ply:19:7: expected the number"));
  std::string binary = text;
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  binary.resize(binary.find("end_header") + 11);
  for (const float x : {0.F, 1.F, 2.F})
    for (const float y : {0.F, 1.F})
      for (const float value : {x, y, 0.F}) append_bytes(value, binary);
  binary.replace(binary.find("vertex 9"), 8, "vertex 6");
  for (const std::int32_t index : {7, 1, 0, 3, 2, -1, 2, 3}) append_bytes(index, binary);
  EXPECT_EQ(measure(read("a.ply", binary)).area_m2, 1);
}

// Text and both byte orders give one mesh, seams and all: temperatures go by a vertex's number. The
// data begin with any byte, and the header's lines end as its first one does.
TEST(PlyImport, NumberingDoesNotDependOnTheEncoding) {
  const std::vector<double> xyz = {1.5, 0, 0, 0, 2, 0, 0, 0, 1, 1.5, 0, 0, 0, 2, 0, 3, 3, 3};
  const auto header = [](const char* format, const std::string& end) {
    std::string out;
    for (const char* line :
         {"ply", "", "comment end_header", "element vertex 6", "property double x",
          "property double y", "property double z", "property float temperature", "element face 2",
          "property list uchar uint vertex_index", "end_header"})
      out += (line[0] == '\0' ? std::string("format ") + format + " 1.0" : line) + end;
    return out;
  };
  std::string text = header("ascii", "\n");
  for (std::size_t i = 0; i < 6; ++i)
    text += std::to_string(xyz[3 * i]) + " " + std::to_string(xyz[3 * i + 1]) + " " +
            std::to_string(xyz[3 * i + 2]) + " nan\n";
  const Mesh expected = read("a.ply", text + "3 0 1 2\n3 3 4 5\n");
  ASSERT_EQ(expected.vertex.size(), 6U);
  for (const bool big : {false, true})
    for (const char* end : {"\n", "\r\n", "\r"}) {
      std::string bytes = header(big ? "binary_big_endian" : "binary_little_endian", end);
      const auto put = [&](auto value) {
        std::string one;
        append_bytes(value, one);
        if (big) std::reverse(one.begin(), one.end());
        bytes += one;
      };
      for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 3; ++j) put(xyz[3 * i + j]);
        put(std::nanf(""));
      }
      for (const std::uint32_t first : {0U, 3U}) {
        bytes += '\3';
        for (std::uint32_t j = 0; j < 3; ++j) put(first + j);
      }
      const Mesh mesh = read("a.ply", bytes);
      EXPECT_EQ(mesh.vertex, expected.vertex) << big << end;
      EXPECT_EQ(mesh.triangle, expected.triangle);
      EXPECT_THAT(refusal("a.ply", bytes.substr(0, bytes.size() - 1)),
                  HasSubstr("a.ply: face 1 (counted from 0) has 3 items, which end behind"));
      bytes[bytes.size() - (big ? 1 : 4)] = 9;
      EXPECT_THAT(refusal("a.ply", bytes), HasSubstr("a.ply: face 1 uses vertex 9, and the file has 6"));
    }
}

TEST(PlyImport, DataMayBeginWithALineEnd) {
  const std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar r\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  for (const char first : {'\n', '\r', ' ', 'A'}) {
    std::string bytes = text;
    for (const Corners::value_type& corner : Corners{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}}) {
      bytes += first;
      for (const float value : corner) append_bytes(value, bytes);
    }
    bytes += '\3';
    for (const std::int32_t i : {0, 1, 2}) append_bytes(i, bytes);
    EXPECT_DOUBLE_EQ(measure(read("a.ply", bytes)).area_m2, 2) << static_cast<int>(first);
  }
}

TEST(PlyImport, ErrorsSayWhere) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_THAT(refusal("a.ply", head + "0 0 0\n1 0 0\n0 1 nan\n3 0 1 2\n"), HasSubstr("a.ply:12:5"));
  EXPECT_THAT(refusal("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
              HasSubstr("a.ply:13:1: vertex 3 does not exist"));
  EXPECT_THAT(refusal("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), HasSubstr("a.ply:13:7"));
  EXPECT_THAT(refusal("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n"), HasSubstr("a.ply:14:1"));
  EXPECT_THAT(refusal("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), HasSubstr("a.ply:13:1"));
  EXPECT_THAT(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty quad x\n"),
              HasSubstr("a.ply:4:10: expected: property"));
  EXPECT_THAT(refusal("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\n"
                      "property int y\nend_header\n"),
              HasSubstr("the element vertex has no property z"));
}

TEST(StlImport, SolidsAreGroupsAndVerticesAreMerged) {
  const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal nan nan nan\n outer loop\n vertex " + a + "\n vertex " + b + "\n vertex " +
           c + "\n endloop\nendfacet\n";
  };
  const std::string o = "0 0 -0", x = "2 0 0", y = "0 3 0", z = "0 0 4";
  const Mesh mesh = read("a.stl", "solid after deck\n" + facet(o, y, x) + facet(o, x, z) +
                                      "endsolid after deck\nSOLID\n" + facet(o, z, y) +
                                      facet(x, y, z) + "endsolid\n");
  EXPECT_EQ(mesh.vertex.size(), 4u);
  EXPECT_THAT(mesh.group, ElementsAre("after deck", "default"));
  EXPECT_EQ(measure(mesh).open_edges, 0u);
  EXPECT_DOUBLE_EQ(measure(mesh).volume_m3, 4);
  EXPECT_THAT(refusal("a.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n"),
              HasSubstr("a.stl:4:12: the coordinate \"inf\" is not finite"));
  EXPECT_THAT(refusal("a.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nendloop\n"),
              HasSubstr("a.stl:5:1: \"endloop\", expected \"vertex\""));
  EXPECT_THAT(refusal("a.stl", "solid s\n"), HasSubstr("a.stl:2:1: the file ends"));
}

// forward, up -> where the file's x, y, z axes go in the body frame.
TEST(Axes, AllTwentyFourAreRightHanded) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  int count = 0;
  for (const char* forward : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
    for (const char* up : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
      MeshImport how;
      how.forward_axis = forward;
      how.up_axis = up;
      if (forward[1] == up[1]) {
        EXPECT_THAT(refusal("a.obj", text, how), HasSubstr("perpendicular"));
        continue;
      }
      ++count;
      const Mesh mesh = read("a.obj", text, how);
      EXPECT_DOUBLE_EQ(measure(mesh).volume_m3, 1) << forward << up;
      const auto image = [&](const char* axis) {
        const std::size_t i = static_cast<std::size_t>(axis[1] - 'x');
        return ((axis[0] == '+' ? 1 : -1) / static_cast<double>(i + 1)) * mesh.vertex[i + 1];
      };
      EXPECT_EQ(image(forward), (Vec<Body>{1, 0, 0}));
      EXPECT_EQ(image(up), (Vec<Body>{0, 0, -1}));
    }
  }
  EXPECT_EQ(count, 24);
}

TEST(Axes, StarboardIsForwardCrossUp) {
  const std::string text = "v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
  const Mesh usual = read("a.obj", text);  // x forward, z up: the file's y is port
  EXPECT_EQ(usual.vertex[1], (Vec<Body>{0, -1, 0}));
  MeshImport gltf;
  gltf.forward_axis = "-z";
  gltf.up_axis = "+y";
  gltf.unit_m = 0.001;
  const Mesh camera = read("a.obj", text, gltf);  // x to the right
  EXPECT_EQ(camera.vertex[0], (Vec<Body>{0, 0.001, 0}));
  EXPECT_EQ(camera.vertex[1], (Vec<Body>{0, 0, -0.001}));
  EXPECT_EQ(camera.vertex[2], (Vec<Body>{-0.001, 0, 0}));
  for (const double unit_m : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    gltf.unit_m = unit_m;
    EXPECT_THAT(refusal("a.obj", text, gltf), HasSubstr("unit_m"));
  }
}

TEST(Reference, BoxCentreAndBottomIgnoreUnusedVertices) {
  const std::string text = "v 90 90 90\nv 2 4 6\nv 4 4 6\nv 4 8 12\nf 2 3 4\n";
  MeshImport how;
  how.reference = "bbox_center";
  EXPECT_EQ(read("a.obj", text, how).vertex[1], (Vec<Body>{-1, 2, 3}));
  how.reference = "bbox_bottom_center";
  EXPECT_EQ(read("a.obj", text, how).vertex[1], (Vec<Body>{-1, 2, 0}));
  how.up_axis = "-z";  // the bottom is then at z = 12
  EXPECT_EQ(read("a.obj", text, how).vertex[3].z, 0);
  how.reference = "middle";
  EXPECT_THAT(refusal("a.obj", text, how), HasSubstr("reference \"middle\""));
  EXPECT_THAT(refusal("a.obj", "v 100 0 0\nv 101 0 0\nv 100 1 0\nf 1 2 3\n"),
              HasSubstr("say reference = \"bbox_center\""));
}

TEST(Groups, OnePartTakesTheRest) {
  Mesh mesh;
  mesh.group = {"deck", "hull/port", "mast", "unused"};
  mesh.triangle_group = {0, 1, 2};
  PartSpec deck, rest;
  deck.name = "deck";
  rest.name = "others";
  rest.rest = true;
  for (const bool first : {false, true}) {
    const std::uint32_t d = first ? 1 : 0, r = first ? 0 : 1;
    const auto parts = first ? std::vector{rest, deck} : std::vector{deck, rest};
    const auto of = part_of_groups(mesh, parts);
    ASSERT_TRUE(of.ok()) << of.status();
    EXPECT_THAT(*of, testing::ElementsAre(d, r, r, r));
  }
  EXPECT_THAT(std::string(part_of_groups(mesh, {deck, rest, rest}).status().message()),
              testing::HasSubstr("part[2].rest: part \"others\" takes the rest already"));
  PartSpec all = deck;
  all.match = {"*"};
  EXPECT_THAT(std::string(part_of_groups(mesh, {all, rest}).status().message()),
              testing::HasSubstr("no group of the model is left for it"));
}

TEST(Groups, MatchWholeOrAnyOfTheirNames) {
  const char* group = "ship/hull/wet steel";
  for (const char* pattern : {"ship", "hull", "wet steel", "*", "h?ll", "wet*", "*steel", "ship/*",
                              "*/hull/*", "s*/h*l*"})
    EXPECT_TRUE(group_matches(group, pattern)) << pattern;
  for (const char* pattern : {"", "hul", "?ull?", "steel", "Hull", "ship/hull", "hull/*", "x*"})
    EXPECT_FALSE(group_matches(group, pattern)) << pattern;
  EXPECT_TRUE(group_matches("funnel_top", "funnel*"));
  EXPECT_FALSE(group_matches("funnel_top", "funnel"));
  EXPECT_TRUE(group_matches("aXbXc", "a*X?"));
}

const std::vector<Corners> kTetrahedron = {{{{0, 0, 0}, {0, 3, 0}, {2, 0, 0}}},
                                           {{{0, 0, 0}, {2, 0, 0}, {0, 0, 4}}},
                                           {{{0, 0, 0}, {0, 0, 4}, {0, 3, 0}}},
                                           {{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}}}};

std::vector<Corners> moved(std::vector<Corners> facets, float x) {
  for (Corners& facet : facets)
    for (auto& corner : facet) corner[0] += x;
  return facets;
}

TEST(Float32Import, BinaryFormsGiveTheSameClosedMesh) {
  for (const auto& [name, bytes] :
       std::map<std::string, std::string>{{"a.stl", binary_stl(kTetrahedron, "solid but binary")},
                                          {"a.ply", binary_ply(kTetrahedron)},
                                          {"a.glb", glb(kTetrahedron)}}) {
    const Mesh mesh = read(name, bytes);
    EXPECT_EQ(mesh.vertex.size(), name == "a.ply" ? 12u : 4u) << name;  // PLY keeps its numbers
    EXPECT_EQ(measure(mesh).open_edges, name == "a.ply" ? 12u : 0u) << name;
    EXPECT_DOUBLE_EQ(measure(mesh).volume_m3, 4) << name;
  }
  EXPECT_THAT(read("a.stl", binary_stl(kTetrahedron)).group, ElementsAre("default"));
  EXPECT_THAT(read("a.glb", glb(kTetrahedron)).group, ElementsAre("ship/steel"));
}

// Bytes behind the last facet are not read, unless they are facets that the count leaves out.
TEST(Float32Import, BinaryStlWithBytesBehind) {
  const std::string stl = binary_stl(kTetrahedron, "solid but binary");
  for (const std::string& behind : {std::string("\n"), std::string("made by hand, with a long note"),
                                    std::string(50, '\0'), std::string(120, 'x')})
    EXPECT_EQ(read("a.stl", stl + behind).triangle.size(), 4u) << behind.size();
  EXPECT_THAT(refusal("a.stl", stl + stl.substr(84, 50)),
              HasSubstr("the header counts 4 facets, and 5 are there"));
}

// A sliver in a large model costs no area: 0.2 mm where float32 is 8 um apart.
TEST(Float32Import, JudgesByTheAreaAtStake) {
  std::vector<Corners> facets;
  for (const Corners& facet : kTetrahedron) {
    Corners large = facet;
    for (auto& corner : large)
      for (float& value : corner) value *= 30;
    facets.push_back(large);
  }
  facets.push_back({{{60, 0, 0}, {60.0002F, 0, 0}, {60, 50, 0}}});
  EXPECT_EQ(read("a.stl", binary_stl(facets)).triangle.size(), 5u);
  EXPECT_THAT(refusal("a.stl", binary_stl({facets.back()})), HasSubstr("of the model's area unsure"));
}

TEST(Float32Import, RefusesWhatFloatCannotResolve) {
  // Facets of a few m2: at 100 km float32 is 8 mm apart, 6400 km away half a metre.
  EXPECT_EQ(read("a.stl", binary_stl(moved(kTetrahedron, 1e5f)), {"", 1, "+x", "+z", "bbox_center"})
                .triangle.size(),
            4u);
  for (const auto& [name, bytes] :
       std::map<std::string, std::string>{{"a.stl", binary_stl(moved(kTetrahedron, 6.4e6f))},
                                          {"a.ply", binary_ply(moved(kTetrahedron, 6.4e6f))},
                                          {"a.glb", glb(moved(kTetrahedron, 6.4e6f))}}) {
    EXPECT_THAT(refusal(name, bytes, {"", 1, "+x", "+z", "bbox_center"}),
                HasSubstr("float32 coordinates"));
  }
}

TEST(Float32Import, RefusesWhatIsBroken) {
  const std::string stl = binary_stl(kTetrahedron);
  EXPECT_THAT(refusal("a.stl", stl.substr(0, stl.size() - 1)), HasSubstr("no complete binary STL"));
  EXPECT_THAT(refusal("a.glb", "solid\n"), HasSubstr("this is no glTF"));
  EXPECT_THAT(refusal("a.gltf", "[]"), HasSubstr("this is no glTF"));
  EXPECT_THAT(refusal("a.fbx", stl), HasSubstr("expected .obj, .ply"));
  EXPECT_THAT(refusal("frigate", stl), HasSubstr("expected .obj, .ply"));
  std::vector<Corners> nan = kTetrahedron;
  nan[1][1][1] = std::nanf("");
  EXPECT_THAT(refusal("a.stl", binary_stl(nan)), HasSubstr("not finite"));
}

// A glTF file may name other files; what is on this machine is none of its business.
TEST(Float32Import, OpensNoOtherFile) {
  const std::string path = testing::TempDir() + "irsig_mesh_test_buffer.bin";
  std::ofstream(path, std::ios::binary) << all_corners({kTetrahedron[0]});
  const auto gltf = [](const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
               "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
               "buffers":[{"byteLength":36,"uri":")" +
           uri + R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],
               "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})";
  };
  // The corners (0,0,0), (1,0,0), (0,1,0) inside the file: read; outside: refused.
  EXPECT_EQ(read("a.gltf", gltf("data:application/octet-stream;base64,"
                                "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"))
                .triangle.size(),
            1u);
  EXPECT_THAT(refusal("a.gltf", gltf(path)), HasSubstr("a.gltf: "));
  std::remove(path.c_str());
}

TEST(Generate, ComesCloseToTheAskedNumberOfTriangles) {
  for (const char* kind : {"disk", "sphere", "box", "cylinder", "cone", "frigate"}) {
    for (const std::uint64_t triangles : {200u, 1000u, 2000u, 3000u, 7777u, 20000u, 200000u}) {
      if (std::string(kind) == "frigate" && triangles < 2000) continue;
      const Mesh mesh = generate_mesh({kind, triangles}).value();
      const double n = static_cast<double>(triangles);
      EXPECT_NEAR(static_cast<double>(mesh.triangle.size()), n, (n < 1000 ? 0.06 : 0.02) * n)
          << kind;
    }
  }
}

TEST(Generate, SolidsAreClosedAndOutward) {
  for (const char* kind : {"sphere", "box", "cylinder", "cone", "frigate"}) {
    const std::uint64_t least = std::string(kind) == "frigate" ? 2000 : 12;
    for (const std::uint64_t triangles : {least, least + 1, 2 * least + 5, std::uint64_t{6000}}) {
      const Mesh mesh = generate_mesh({kind, triangles}).value();
      const MeshMeasure m = measure(mesh);
      EXPECT_EQ(m.open_edges, 0u) << kind << triangles;
      EXPECT_GT(m.volume_m3, 0) << kind << triangles;
      EXPECT_EQ(mesh.degenerate_triangles, 0u) << kind << triangles;
    }
  }
}

TEST(Generate, DimensionsAndTheirMistakes) {
  const MeshMeasure box = measure(generate_mesh({"box", 500, 0, 7, 0, 3}).value());
  EXPECT_EQ(box.box_max, (Vec<Body>{3.5, 0.5, 1.5}));
  EXPECT_NEAR(box.volume_m3, 21, 1e-12);
  const auto refused = [](const MeshGenerator& what) {
    const absl::Status status = generate_mesh(what).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return std::string(status.message());
  };
  EXPECT_THAT(refused({"boat", 500}), HasSubstr("model \"boat\", expected one of disk"));
  EXPECT_THAT(refused({"box", 500, 1}), HasSubstr("a box has no radius_m"));
  EXPECT_THAT(refused({"disk", 500, 0, 1}), HasSubstr("a disk has no length_m"));
  EXPECT_THAT(refused({"disk", 500, -1}), HasSubstr("radius_m = -1"));
  EXPECT_THAT(refused({"disk", 500, std::nan("")}), HasSubstr("radius_m = nan"));
  EXPECT_THAT(refused({"disk", 2}), HasSubstr("triangles = 2, expected 3 to"));
  EXPECT_THAT(refused({"frigate", 0}), HasSubstr("triangles = 0, expected 2000 to"));
}

TEST(Frigate, IsExactlySymmetric) {
  const Mesh mesh = generate_mesh({"frigate", 5000}).value();
  using Key = std::tuple<double, double, double>;
  std::map<Key, int> corners;
  for (const Vec<Body>& v : mesh.vertex) ++corners[{v.x, v.y, v.z}];
  for (const Vec<Body>& v : mesh.vertex)
    EXPECT_EQ((corners[{v.x, v.y, v.z}]), (corners[{v.x, -v.y + 0.0, v.z}]));
  // Every facet has its mirror image, of the same group, wound the other way.
  using Facet = std::tuple<std::uint32_t, Key, Key, Key>;
  std::map<Facet, int> count;
  const auto facet = [&](std::size_t i, double side, bool reversed) {
    std::array<Key, 3> k;
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec<Body>& v = mesh.vertex[mesh.triangle[i][reversed ? 2 - j : j]];
      k[j] = {v.x, side * v.y + 0.0, v.z};
    }
    std::rotate(k.begin(), std::min_element(k.begin(), k.end()), k.end());
    return Facet{mesh.triangle_group[i], k[0], k[1], k[2]};
  };
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) ++count[facet(i, 1, false)];
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i)
    ASSERT_EQ(count[facet(i, 1, false)], count[facet(i, -1, true)]) << i;
}

TEST(Frigate, HasItsSizeAndGroups) {
  const Mesh mesh = generate_mesh({"frigate", 20000}).value();
  EXPECT_THAT(mesh.group, ElementsAre("hull", "deck", "superstructure", "funnel", "funnel_top",
                                      "mast", "mast_hot", "turret"));
  const MeshMeasure m = measure(mesh);
  EXPECT_DOUBLE_EQ(m.box_max.x - m.box_min.x, 153.8);
  EXPECT_DOUBLE_EQ(m.box_max.y - m.box_min.y, 20.4);
  EXPECT_EQ(m.box_max.z, -0.001);
  const MeshMeasure twice = measure(generate_mesh({"frigate", 20000, 0, 307.6, 0, 12.8}).value());
  EXPECT_DOUBLE_EQ(twice.box_max.x - twice.box_min.x, 307.6);
  EXPECT_DOUBLE_EQ(twice.box_max.y - twice.box_min.y, 20.4);
  EXPECT_DOUBLE_EQ(twice.box_min.z, 2 * m.box_min.z);
}

TEST(WriteObj, ReadsBackTheSameBits) {
  for (const char* kind : {"disk", "sphere", "box", "cylinder", "cone", "frigate"}) {
    const Mesh mesh = generate_mesh({kind, 3000}).value();
    const Mesh back = read("a.obj", write_obj(mesh));
    EXPECT_EQ(back.vertex, mesh.vertex) << kind;
    EXPECT_EQ(back.triangle, mesh.triangle) << kind;
    EXPECT_EQ(back.triangle_group, mesh.triangle_group) << kind;
    EXPECT_EQ(back.group, mesh.group) << kind;
  }
  const Mesh named = read("a.obj", kTetrahedronObj);  // names with blanks, more than one of them
  EXPECT_EQ(read("a.obj", write_obj(named)).group, named.group);
}

}  // namespace
}  // namespace irsig
