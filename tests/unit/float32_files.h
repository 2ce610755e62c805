#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Writers of the binary mesh forms, for tests of their import.
namespace irsig {

using Corners = std::array<std::array<float, 3>, 3>;

template <typename Number>
void append_bytes(Number value, std::string& out) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

inline std::string all_corners(const std::vector<Corners>& facets) {
  std::string out;
  for (const Corners& facet : facets)
    for (const auto& corner : facet)
      for (const float value : corner) append_bytes(value, out);
  return out;
}

inline std::string binary_stl(const std::vector<Corners>& facets, std::string header = "binary") {
  header.resize(80);
  append_bytes(static_cast<std::uint32_t>(facets.size()), header);
  for (const Corners& facet : facets)
    header += std::string(12, '\0') + all_corners({facet}) + std::string(2, '\0');
  return header;
}

inline std::string binary_ply(const std::vector<Corners>& facets) {
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                    std::to_string(3 * facets.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                    std::to_string(facets.size()) +
                    "\nproperty list uchar int vertex_indices\nend_header\n" + all_corners(facets);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(facets.size()); ++i) {
    out += '\3';
    for (std::int32_t j = 0; j < 3; ++j) append_bytes(3 * i + j, out);
  }
  return out;
}

// The container of a GLB around its JSON and its buffer.
inline std::string glb_file(std::string json, const std::string& buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out = "glTF";
  append_bytes(std::uint32_t{2}, out);
  append_bytes(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()), out);
  append_bytes(static_cast<std::uint32_t>(json.size()), out);
  out += "JSON" + json;
  append_bytes(static_cast<std::uint32_t>(buffer.size()), out);
  out += std::string("BIN\0", 4) + buffer;
  return out;
}

// One node and mesh "ship" of the material "steel", without indices.
inline std::string glb(const std::vector<Corners>& facets) {
  const std::string buffer = all_corners(facets), size = std::to_string(buffer.size());
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"mesh":0,"name":"ship"}],"materials":[{"name":"steel"}],)"
      R"("meshes":[{"name":"ship","primitives":[{"attributes":{"POSITION":0},"material":0}]}],)"
      R"("buffers":[{"byteLength":)" +
      size + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + size +
      R"(}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
      std::to_string(3 * facets.size()) + "}]}";
  return glb_file(std::move(json), buffer);
}

inline std::string base64(std::string_view bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      out += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63];
  }
  return out;
}

// A tetrahedron with indices, one more as a strip, and one with a sparse accessor, on nodes that
// are scaled, turned, moved and given by a matrix: its JSON and the bytes of its buffer. uri is
// that of the buffer, none in a GLB.
struct GltfScene {
  std::string json, buffer;
};
inline GltfScene gltf_scene(bool in_json) {
  GltfScene out;
  for (const float v : {0.F, 0.F, 0.F, 3.F, 0.F, 0.F, 0.F, 2.F, 0.F, 0.F, 0.F, 4.F})
    append_bytes(v, out.buffer);  // bytes 0 to 48: positions
  for (const int i : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3})
    append_bytes(static_cast<std::uint16_t>(i), out.buffer);  // 48 to 72: indices
  out.buffer += std::string("\0\1\2\3", 4);                   // 72 to 76: a strip
  append_bytes(5.0F, out.buffer);  // 76 to 88: what the sparse accessor puts in place of vertex 3
  append_bytes(0.0F, out.buffer);
  append_bytes(1.0F, out.buffer);
  const std::string size = std::to_string(out.buffer.size());
  const std::string uri =
      in_json ? R"(,"uri":"data:application/octet-stream;base64,)" + base64(out.buffer) + '"' : "";
  out.json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"name":"s","nodes":[0,3]}],"nodes":[)"
      R"({"name":"ship","mesh":0,"children":[1,2],"scale":[2,2,2]},)"
      R"({"name":"mast","mesh":1,"translation":[0,0,1],"rotation":[0,0,0.6,0.8]},)"
      R"({"name":"crane","mesh":2},)"
      R"({"name":"boat","mesh":0,"matrix":[1,0,0,0,0,0,1,0,0,-1,0,0,9,0,0,1]}],)"
      R"("materials":[{"name":"steel"},{"name":"paint"}],"meshes":[)"
      R"({"name":"hull","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0},)"
      R"({"attributes":{"POSITION":0},"indices":2,"material":1,"mode":5}]},)"
      R"({"name":"pole","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1}]},)"
      R"({"name":"hook","primitives":[{"attributes":{"POSITION":3},"indices":1}]}],"accessors":[)"
      R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[3,2,4]},)"
      R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"},)"
      R"({"bufferView":2,"byteOffset":0,"componentType":5121,"count":4,"type":"SCALAR"},)"
      R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,)"
      R"("indices":{"bufferView":2,"byteOffset":3,"componentType":5121},)"
      R"("values":{"bufferView":3}}}],"bufferViews":[)"
      R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24},)"
      R"({"buffer":0,"byteOffset":72,"byteLength":4},{"buffer":0,"byteOffset":76,"byteLength":12}],)"
      R"("buffers":[{"byteLength":)" +
      size + uri + "}]}";
  return out;
}

}  // namespace irsig
