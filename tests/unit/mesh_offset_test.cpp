// Text files far from the origin: Earth-centred coordinates are 6.4e6 m.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/scene/generate/generate_mesh.h"
#include "core/scene/import/import_mesh.h"
#include "tests/unit/float32_files.h"
#include "verify/watertight/hit_judge.h"
#include "verify/watertight/watertight_check.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

std::string number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string coordinates(const Vec<Body>& v, double offset_m) {
  return number(v.x + offset_m) + " " + number(v.y + offset_m) + " " + number(v.z + offset_m);
}

std::string as_obj(const Mesh& mesh, double offset_m) {
  std::string out;
  for (const Vec<Body>& v : mesh.vertex) out += "v " + coordinates(v, offset_m) + "\n";
  for (const auto& t : mesh.triangle)
    out += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " +
           std::to_string(t[2] + 1) + "\n";
  return out;
}

std::string as_ply(const Mesh& mesh, double offset_m) {
  std::string out = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertex.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                    std::to_string(mesh.triangle.size()) +
                    "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec<Body>& v : mesh.vertex) out += coordinates(v, offset_m) + "\n";
  for (const auto& t : mesh.triangle)
    out += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) +
           "\n";
  return out;
}

std::string as_stl(const Mesh& mesh, double offset_m) {
  std::string out = "solid s\n";
  for (const auto& t : mesh.triangle) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t i : t) out += "vertex " + coordinates(mesh.vertex[i], offset_m) + "\n";
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid\n";
}

Mesh import_centred(const std::string& name, const std::string& bytes) {
  MeshImport how;
  how.file_name = name;
  how.reference = "bbox_center";
  absl::StatusOr<Mesh> mesh = import_mesh(bytes, how);
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return mesh.ok() ? *std::move(mesh) : Mesh{};
}

struct TextForm {
  const char* name;
  std::string (*write)(const Mesh&, double);
};
const TextForm kForms[] = {{"a.obj", as_obj}, {"a.ply", as_ply}, {"a.stl", as_stl}};

double farthest_apart(const Mesh& a, const Mesh& b) {
  double out = a.vertex.size() == b.vertex.size() ? 0 : HUGE_VAL;
  for (std::size_t i = 0; i < std::min(a.vertex.size(), b.vertex.size()); ++i)
    out = std::max(out, length(a.vertex[i] - b.vertex[i]));
  return out;
}

// Whole multiples of 2^-20 m survive the sum exactly: not one bit may differ.
TEST(MeshOffset, CoordinatesThatFitComeBackBitForBit) {
  Mesh mesh = generate_mesh({"frigate", 5000}).value();
  for (Vec<Body>& v : mesh.vertex)
    v = {std::round(v.x * 0x1p20) * 0x1p-20, std::round(v.y * 0x1p20) * 0x1p-20,
         std::round(v.z * 0x1p20) * 0x1p-20};
  for (const TextForm& form : kForms) {
    const Mesh near = import_centred(form.name, form.write(mesh, 0));
    for (const double offset_m : {1e3, 1e5, 6.4e6}) {
      const Mesh far = import_centred(form.name, form.write(mesh, offset_m));
      EXPECT_EQ(far.vertex, near.vertex) << form.name << " " << offset_m;
      EXPECT_EQ(far.triangle, near.triangle) << form.name << " " << offset_m;
      EXPECT_EQ(HitJudge(far).vertex(), HitJudge(near).vertex()) << form.name << " " << offset_m;
    }
  }
}

// Other coordinates lose what a double cannot hold: half a unit in the last place of the offset in
// each axis of the vertex and of the box's centre.
TEST(MeshOffset, OthersMoveByTheRoundingOfTheOffset) {
  const Mesh mesh = generate_mesh({"frigate", 5000}).value();
  for (const TextForm& form : kForms) {
    const Mesh near = import_centred(form.name, form.write(mesh, 0));
    for (const double offset_m : {1e3, 1e5, 6.4e6}) {
      const Mesh far = import_centred(form.name, form.write(mesh, offset_m));
      const double spacing = std::nextafter(offset_m + 100, HUGE_VAL) - (offset_m + 100);
      EXPECT_LE(farthest_apart(near, far), 2 * std::sqrt(3.0) * spacing)
          << form.name << " " << offset_m;
    }
  }
  // At the Earth's surface that is 3 nm; float32 would leave half a metre.
  EXPECT_LT(farthest_apart(import_centred("a.obj", as_obj(mesh, 0)),
                           import_centred("a.obj", as_obj(mesh, 6.4e6))),
            4e-9);
}

// Forms stored in float are refused where their rounding leaves more than 1 % of the area unsure: for
// two facets of edges a and b and a spacing d, d (1.41 a + 1.41 b) / (a^2 + b^2).
TEST(MeshOffset, FloatFormsAreRefusedWhereTheirAreaIsUnsure) {
  const auto facets = [](float offset, float edge) {
    return std::vector<Corners>{{{{offset, 0, 0}, {offset + 1, 0, 0}, {offset, 1, 0}}},
                                {{{offset, 0, 1}, {offset + edge, 0, 1}, {offset, edge, 1}}}};
  };
  // The spacing at 5e4 is 2^-8 m: edges of 0.25 m leave 0.65 %, at 1e5 1.3 %.
  for (const auto& write : {+[](const std::vector<Corners>& c) { return binary_stl(c); },
                            +[](const std::vector<Corners>& c) { return binary_ply(c); }}) {
    const bool stl = write({}).substr(0, 3) != "ply";
    MeshImport how;
    how.file_name = stl ? "a.stl" : "a.ply";
    how.reference = "bbox_center";
    EXPECT_TRUE(import_mesh(write(facets(5e4f, 0.25f)), how).ok());
    const absl::Status refused = import_mesh(write(facets(1e5f, 0.25f)), how).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(refused.message()), HasSubstr("float32 coordinates"));
    EXPECT_TRUE(import_mesh(write(facets(0, 0.001f)), how).ok());
  }
}

}  // namespace
}  // namespace irsig
