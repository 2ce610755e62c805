#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
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

}  // namespace irsig
