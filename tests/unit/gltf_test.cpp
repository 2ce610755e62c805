// Rationale: what a glTF file says of its geometry beyond plain meshes, each by the area or the
// places that follow from its own numbers; and what is refused, by the name that a user can look
// up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/base/user_file.h"
#include "core/scene/import/import_formats.h"
#include "core/scene/import/import_json.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/import/model_file.h"
#include "core/scene/mesh.h"
#include "core/scene/mesh_measure.h"
#include "tests/unit/float32_files.h"
#include "tests/unit/test_folder.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

// A glTF file of one box, 4 x 2 x 1 (28 m2): its pieces, for tests to change and to add to.
struct BoxFile {
  std::string extra;  // of the file: "extensionsRequired", "skins" ...
  std::string node = R"("mesh":0)";
  std::string nodes;      // more of them, with a comma in front
  std::string mesh;       // of the mesh: "weights"
  std::string primitive;  // of the primitive: "targets" ...
  std::string attributes;
  std::string position_type = R"("componentType":5126)";
  std::string accessors, views;
  int position_accessor = 0, index_accessor = 1;
  std::string buffer;

  BoxFile() {
    for (int i = 0; i < 8; ++i)
      for (int axis = 0; axis < 3; ++axis) append_bytes(corner(i, axis), buffer);  // bytes 0 to 96
    for (const int i : {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5})
      quad.push_back(static_cast<std::uint16_t>(i));
    for (std::size_t f = 0; f < 24; f += 4)
      for (const std::size_t j : {0, 1, 2, 0, 2, 3}) append_bytes(quad[f + j], buffer);
  }
  static float corner(int i, int axis) {
    const float half[] = {2, 1, 0.5F};
    return (i >> axis & 1) != 0 ? half[axis] : -half[axis];
  }
  // Adds bytes, a view of them and an accessor; returns the accessor's number.
  int add(const std::string& bytes, const std::string& accessor) {
    const int view = 2 + views_added++;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    views += R"(,{"buffer":0,"byteOffset":)" + std::to_string(buffer.size()) + R"(,"byteLength":)" +
             std::to_string(bytes.size()) + "}";
    buffer += bytes;
    accessors += R"(,{"bufferView":)" + std::to_string(view) + "," + accessor + "}";
    return view;
  }
  [[nodiscard]] std::string json(const std::string& uri = "") const {
    return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0)" + scene + R"(]}],)" + extra +
           R"("nodes":[{)" + node + "}" + nodes + R"(],"meshes":[{)" + mesh +
           R"("primitives":[{"attributes":{"POSITION":)" + std::to_string(position_accessor) +
           attributes + R"(},"indices":)" + std::to_string(index_accessor) + primitive +
           R"(}]}],"accessors":[{"bufferView":0,)" + position_type +
           R"(,"count":8,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":36,)" +
           R"("type":"SCALAR"})" + accessors + R"(],"bufferViews":[{"buffer":0,"byteLength":96},)" +
           R"({"buffer":0,"byteOffset":96,"byteLength":72})" + views +
           R"(],"buffers":[{"byteLength":)" + std::to_string(buffer.size()) + uri + "}]}";
  }
  [[nodiscard]] absl::StatusOr<Mesh> read() const {
    return import_mesh(glb_file(json(), buffer), {"box.glb", 1, "+x", "+z", "origin"});
  }
  std::string scene;
  std::vector<std::uint16_t> quad;
  int views_added = 0;
};

std::string floats(std::initializer_list<float> values) {
  std::string out;
  for (const float v : values) append_bytes(v, out);
  return out;
}

double area_of(const BoxFile& file) {
  const absl::StatusOr<Mesh> mesh = file.read();
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return mesh.ok() ? measure(*mesh).area_m2 : 0;
}

std::string refusal_of(const BoxFile& file) {
  const absl::StatusOr<Mesh> mesh = file.read();
  EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument) << mesh.status();
  return std::string(mesh.status().message());
}

TEST(Gltf, TheBoxIsClosedAndOutward) {
  const Mesh mesh = *BoxFile().read();
  EXPECT_DOUBLE_EQ(measure(mesh).area_m2, 28);
  EXPECT_DOUBLE_EQ(measure(mesh).volume_m3, 8);
  EXPECT_EQ(mesh.group, std::vector<std::string>{"nodes[0]/meshes[0]"});
}

TEST(Gltf, NodesMoveTurnScaleAndMirror) {
  BoxFile file;
  file.node = R"("mesh":0,"scale":[2,2,2])";
  EXPECT_DOUBLE_EQ(area_of(file), 4 * 28);
  file.node = R"("mesh":0,"scale":[-1,1,1])";
  EXPECT_DOUBLE_EQ(measure(*file.read()).volume_m3, 8);  // not inside out
  file.node = R"("children":[1],"rotation":[0,0,7,7],"translation":[10,0,0])";
  file.nodes = R"(,{"mesh":0,"translation":[1,0,0]})";
  const MeshMeasure turned = measure(*file.read());  // a quarter turn about z, of any length
  EXPECT_NEAR(turned.box_max.x, 11, 1e-12);
  EXPECT_NEAR(-turned.box_min.y, 3, 1e-12);  // the file's y is port
}

TEST(Gltf, InstancesAreCopies) {
  BoxFile file;
  file.extra = R"("extensionsRequired":["EXT_mesh_gpu_instancing"],)";
  const int at = file.add(floats({0, 0, 0, 10, 0, 0, 20, 0, 0}),
                          R"("componentType":5126,"count":3,"type":"VEC3")");
  const int size = file.add(floats({1, 1, 1, 2, 2, 2, 3, 3, 3}),
                            R"("componentType":5126,"count":3,"type":"VEC3")");
  file.node = R"("mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
              std::to_string(at) + R"(,"SCALE":)" + std::to_string(size) + "}}}";
  EXPECT_DOUBLE_EQ(area_of(file), 28 * (1 + 4 + 9));
  // Five bodies that are moved and nothing else.
  BoxFile five;
  const int row = five.add(floats({0, 0, 0, 10, 0, 0, 20, 0, 0, 30, 0, 0, 40, 0, 0}),
                           R"("componentType":5126,"count":5,"type":"VEC3")");
  five.node = R"("mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
              std::to_string(row) + "}}}";
  EXPECT_DOUBLE_EQ(area_of(five), 140);
  file.node.replace(file.node.find("TRANSLATION"), 11, "_TRANSLATED");
  EXPECT_DOUBLE_EQ(area_of(file), 28 * (1 + 4 + 9));
  file.node.replace(file.node.find("SCALE"), 5, "_SIZE");
  EXPECT_THAT(refusal_of(file), HasSubstr("has no TRANSLATION, ROTATION or SCALE"));
}

TEST(Gltf, DefaultMorphWeightsMoveVertices) {
  BoxFile file;
  std::string shift;
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) append_bytes(BoxFile::corner(i, axis), shift);
  const int target = file.add(shift, R"("componentType":5126,"count":8,"type":"VEC3")");
  file.primitive = R"(,"targets":[{"POSITION":)" + std::to_string(target) + "}]";
  EXPECT_DOUBLE_EQ(area_of(file), 28);
  file.mesh = R"("weights":[1],)";
  EXPECT_DOUBLE_EQ(area_of(file), 4 * 28);  // twice as large
  file.node = R"("mesh":0,"weights":[2])";  // the node's weights go before the mesh's
  EXPECT_DOUBLE_EQ(area_of(file), 9 * 28);
}

// The node of a skinned mesh does not move it: its joints do.
TEST(Gltf, JointsCarryASkinnedMesh) {
  BoxFile file;
  const int joint =
      file.add(std::string(32, '\0'), R"("componentType":5121,"count":8,"type":"VEC4")");
  std::string weight;
  for (int i = 0; i < 8; ++i)
    for (const float w : {0.5F, 0.F, 0.F, 0.F}) append_bytes(w, weight);  // of a sum of 0.5
  const int weights = file.add(weight, R"("componentType":5126,"count":8,"type":"VEC4")");
  const int bound = file.add(floats({0.5F, 0, 0, 0, 0, 0.5F, 0, 0, 0, 0, 0.5F, 0, 0, 0, 0, 1}),
                             R"("componentType":5126,"count":1,"type":"MAT4")");
  file.attributes =
      R"(,"JOINTS_0":)" + std::to_string(joint) + R"(,"WEIGHTS_0":)" + std::to_string(weights);
  file.node = R"("mesh":0,"skin":0,"scale":[7,7,7])";
  file.nodes = R"(,{"scale":[6,6,6],"name":"joint"})";
  file.scene = ",1";
  file.extra = R"("skins":[{"joints":[1],"inverseBindMatrices":)" + std::to_string(bound) + "}],";
  EXPECT_DOUBLE_EQ(area_of(file), 9 * 28);  // 6 x 0.5
  file.nodes =
      R"(,{"scale":[2,2,2],"name":"joint"})";  // undoes the bind matrix: 28, not 7 x 7 x 28
  EXPECT_DOUBLE_EQ(area_of(file), 28);
  file.attributes = "";
  EXPECT_THAT(refusal_of(file), HasSubstr("has no JOINTS_0 and WEIGHTS_0"));
}

TEST(Gltf, QuantisedPositionsAreNumbersOrFractions) {
  for (const bool normalized : {false, true}) {
    BoxFile file;
    file.extra = R"("extensionsRequired":["KHR_mesh_quantization"],)";
    file.position_type = R"("componentType":5122)";
    std::string bytes;
    for (int i = 0; i < 8; ++i)
      for (int axis = 0; axis < 4; ++axis)
        append_bytes(static_cast<std::int16_t>(axis == 3 ? 0 : 2 * BoxFile::corner(i, axis)),
                     bytes);
    file.buffer.replace(0, 64, bytes);
    std::string json = file.json();
    json.replace(json.find(R"({"buffer":0,"byteLength":96})"), 28,
                 R"({"buffer":0,"byteLength":64,"byteStride":8})");
    if (normalized) {
      const std::size_t at = json.find(R"("componentType":5122)");
      json.replace(at, 20, R"("componentType":5122,"normalized":true)");
    }
    const absl::StatusOr<Mesh> mesh =
        import_mesh(glb_file(json, file.buffer), {"a.glb", 1, "+x", "+z", "origin"});
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    const double scale = normalized ? 1 / 32767.0 : 1;
    EXPECT_NEAR(measure(*mesh).area_m2, 4 * 28 * scale * scale, 1e-12 * scale * scale);
  }
}

// Positions between normals and texture coordinates, in one view with a stride.
TEST(Gltf, InterleavedAttributes) {
  BoxFile file;
  std::string rows;
  for (int i = 0; i < 8; ++i) {
    rows += floats({9, 9});
    for (int axis = 0; axis < 3; ++axis) append_bytes(BoxFile::corner(i, axis), rows);
  }
  file.add(rows, R"("byteOffset":8,"componentType":5126,"count":8,"type":"VEC3")");
  file.views.insert(file.views.size() - 1, R"(,"byteStride":20)");
  file.position_accessor = 2;
  EXPECT_DOUBLE_EQ(area_of(file), 28);
}

// A sparse accessor without a view begins with zeros; one with a view changes some elements.
TEST(Gltf, SparseAccessors) {
  std::string which, all;
  for (int i = 0; i < 8; ++i) {
    append_bytes(static_cast<std::uint8_t>(i), which);
    for (int axis = 0; axis < 3; ++axis) append_bytes(BoxFile::corner(i, axis), all);
  }
  const auto with = [&](const std::string& base, const std::string& values) {
    BoxFile file;
    const int indices = file.add(which, R"("componentType":5121,"count":8,"type":"SCALAR")");
    const int value = file.add(values, R"("componentType":5126,"count":8,"type":"VEC3")");
    file.accessors += R"(,{)" + base + R"("componentType":5126,"count":8,"type":"VEC3","sparse":)" +
                      R"({"count":8,"indices":{"bufferView":)" + std::to_string(indices) +
                      R"(,"componentType":5121},"values":{"bufferView":)" + std::to_string(value) +
                      "}}}";
    file.position_accessor = 4;
    return area_of(file);
  };
  EXPECT_DOUBLE_EQ(with("", all), 28);
  std::string twice;
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) append_bytes(2 * BoxFile::corner(i, axis), twice);
  EXPECT_DOUBLE_EQ(with(R"("bufferView":0,)", twice), 4 * 28);
}

TEST(Gltf, StripsFansAndNumbersOfEveryWidth) {
  // A rectangle of 4 x 2 m: the corners 0 to 3 of the box.
  for (const auto& [mode, order] :
       {std::pair{5, std::vector<int>{0, 1, 2, 3}}, std::pair{6, std::vector<int>{0, 1, 3, 2}}})
    for (const int bytes : {1, 2, 4}) {
      BoxFile file;
      std::string numbers;
      for (const int i : order) {
        numbers += static_cast<char>(i);
        numbers.append(static_cast<std::size_t>(bytes - 1), '\0');
      }
      const int type = bytes == 1 ? 5121 : bytes == 2 ? 5123 : 5125;
      file.index_accessor = file.add(
          numbers, R"("componentType":)" + std::to_string(type) + R"(,"count":4,"type":"SCALAR")");
      file.primitive = R"(,"mode":)" + std::to_string(mode);
      EXPECT_DOUBLE_EQ(area_of(file), 8) << mode << " " << bytes;
    }
}

TEST(Gltf, HiddenNodesAreNotThere) {
  BoxFile file;
  file.nodes =
      R"(,{"mesh":0,"translation":[9,0,0],"extensions":{"KHR_node_visibility":{"visible":false}}})";
  file.scene = ",1";
  EXPECT_DOUBLE_EQ(area_of(file), 28);
  file.nodes.replace(file.nodes.find("false"), 5, "true");
  EXPECT_DOUBLE_EQ(area_of(file), 56);
}

TEST(Gltf, WhatIsNotReadIsRefusedByItsName) {
  BoxFile file;
  file.extra = R"("extensionsRequired":["KHR_materials_unlit","ACME_warp"],)";
  EXPECT_THAT(refusal_of(file), HasSubstr("box.glb: extensionsRequired: the extension ACME_warp"));
  file.extra = R"("extensionsRequired":["KHR_draco_mesh_compression"],)";
  EXPECT_THAT(refusal_of(file), HasSubstr("KHR_draco_mesh_compression"));
  file.extra = R"("extensionsRequired":["KHR_materials_unlit"],)";
  EXPECT_DOUBLE_EQ(area_of(file), 28);
  // Compressed, and not said to be required: refused where there is no plain copy.
  file = BoxFile();
  file.primitive = R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}})";
  EXPECT_DOUBLE_EQ(area_of(file), 28);
  file.position_type = R"("componentType":5126,"x":0)";
  std::string json = file.json();
  json.replace(json.find(R"("bufferView":0,"componentType":5126)"), 15, "");
  const absl::Status status =
      import_mesh(glb_file(json, file.buffer), {"a.glb", 1, "+x", "+z", "origin"}).status();
  EXPECT_THAT(
      std::string(status.message()),
      HasSubstr("meshes[0].primitives[0]: the extension KHR_draco_mesh_compression is not"));
}

TEST(Gltf, ErrorsNameTheirPlace) {
  BoxFile file;
  file.node = R"("mesh":3)";
  EXPECT_THAT(refusal_of(file), HasSubstr("meshes[3]: does not exist: the file has 1 meshes"));
  file.node = R"("mesh":0,"matrix":[1,2])";
  EXPECT_THAT(refusal_of(file), HasSubstr("nodes[0]: expected a matrix of 16 numbers"));
  file.node = R"("children":[1])";
  file.nodes = R"(,{"children":[0]})";
  EXPECT_THAT(refusal_of(file), HasSubstr("expected"));
  file.nodes = R"(,{"mesh":0},{"children":[1]})";
  EXPECT_THAT(refusal_of(file), HasSubstr("nodes[1]: is the child of nodes[0] and of nodes[2]"));
  const auto message = [](const std::string& bytes) {
    return std::string(import_mesh(bytes, {"a.glb", 1, "+x", "+z", "origin"}).status().message());
  };
  const std::string glb = glb_file(BoxFile().json(), BoxFile().buffer);
  EXPECT_THAT(message(glb.substr(0, glb.size() - 4)), HasSubstr("a.glb: the file is cut short"));
  std::string other = glb;
  other[4] = 1;
  EXPECT_THAT(message(other), HasSubstr("this is GLB of version 1, expected version 2"));
  std::string odd = glb;  // a chunk of JSON whose length is no multiple of 4
  odd[12] = static_cast<char>(odd[12] - 1);
  EXPECT_THAT(message(odd), HasSubstr("bytes, and GLB requires a multiple of 4: fill it up"));
  std::string json = BoxFile().json();
  json.replace(json.find("\"2.0\""), 5, "\"1.0\"");
  EXPECT_THAT(message(glb_file(json, BoxFile().buffer)), HasSubstr("this is glTF 1.0"));
  EXPECT_THAT(message("{\"asset\": {\"version\": \"2.0\"},\n  nodes: []}"),
              HasSubstr("a.glb:2:3: this is no JSON, expected a name in quotes"));
  EXPECT_THAT(message("{\"a\":" + std::string(1000, '[')), HasSubstr("nested at most 100 deep"));
}

TEST(Json, TextsNumbersAndEscapes) {
  const JsonValue value = *parse_json(
      " {\"a\\n\\u00e9\\ud83d\\ude00\": [1e-400, -2.5E3, true, null], \"b\": {}}\n", "j");
  ASSERT_EQ(value.member.size(), 2U);
  EXPECT_EQ(value.member[0].name, "a\n\xc3\xa9\xf0\x9f\x98\x80");
  EXPECT_EQ(value.member[0].value.item[0].number, 0);
  EXPECT_EQ(value.member[0].value.item[1].number, -2500);
  EXPECT_TRUE(value.member[0].value.item[2].boolean);
  for (const char* bad :
       {"", "{", "[1,]", "{\"a\" 1}", "\"a", "01", "1 2", "nul", "\"\\x\"", "[1e999]"})
    EXPECT_FALSE(parse_json(bad, "j").ok()) << bad;
}

// A model in pieces: the buffer is a file beside it, and what is read back is one text.
TEST(ModelFile, BuffersBesideAreTakenIn) {
  const TestFolder folder;
  const BoxFile box;
  const auto write = [&](const std::string& name, const std::string& bytes) {
    std::ofstream(folder.file(name), std::ios::binary) << bytes;
  };
  const auto read = [&](const std::string& uri) {
    write("box.gltf", box.json(R"(,"uri":")" + uri + "\""));
    return read_model_file(folder.file("box.gltf"), kMostModelBytes);
  };
  write("box buffer.bin", box.buffer);
  const auto text = read("box%20buffer.bin");
  ASSERT_TRUE(text.ok()) << text.status();
  std::filesystem::remove(folder.file("box buffer.bin"));
  const absl::StatusOr<Mesh> mesh = import_mesh(*text, {"box.gltf", 1, "+x", "+z", "origin"});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_DOUBLE_EQ(measure(*mesh).area_m2, 28);
  EXPECT_THAT(std::string(read("box%20buffer.bin").status().message()),
              HasSubstr("buffers[0].uri \"box%20buffer.bin\": no such file"));
  for (const char* outside : {"/etc/passwd", "../b.bin", "%2e%2e/b.bin", "http://a/b.bin"})
    EXPECT_THAT(std::string(read(outside).status().message()),
                HasSubstr("expected a file in the folder of the model"))
        << outside;
  std::filesystem::create_symlink("/etc/passwd", folder.file("link.bin"));
  EXPECT_THAT(std::string(read("link.bin").status().message()), HasSubstr("lies outside"));
}

TEST(StatedFrame, WhatFormatsAndCommentsState) {
  EXPECT_EQ(stated_frame("{}", "A.GLTF").up_axis, "+y");
  EXPECT_EQ(stated_frame("glTF", "a.glb").forward_axis, "+z");
  const auto unit = [](const char* text, const char* name) {
    return stated_frame(text, name).unit_m.value_or(0);
  };
  EXPECT_EQ(unit("# Exported from a modeller\n# File units = inches\nv 0 0 0\n", "a.obj"), 0.0254);
  EXPECT_EQ(
      unit("# This file uses centimeters as units for non-parametric coordinates.\n", "a.obj"),
      0.01);
  EXPECT_EQ(unit("ply\nformat ascii 1.0\ncomment unit: mm\nend_header\n", "a.ply"), 0.001);
  EXPECT_EQ(unit("solid part UNITS=mm\n", "a.stl"), 0.001);
  EXPECT_EQ(unit("# units: feet or metres\n", "a.obj"), 0);
  EXPECT_EQ(unit("# exported in 2 m of cable\nv 0 0 0\n", "a.obj"), 0);
  EXPECT_EQ(unit("v 0 0 0\n# units: mm\n", "a.obj"), 0);
  EXPECT_FALSE(stated_frame("v 0 0 0\n", "a.obj").up_axis);
}

}  // namespace
}  // namespace irsig
