// Binary STL: 80 bytes of any text, the number of facets, 50 bytes a facet. Bytes behind the last
// facet, as some programs leave them, are not read.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/base/printable.h"
#include "core/scene/import/import_formats.h"
#include "fmt/format.h"

namespace irsig {
namespace {

constexpr std::uint64_t kStlHead = 84, kStlFacet = 50;

std::uint32_t stl_word(std::string_view bytes, std::uint64_t at) {
  std::uint32_t out = 0;
  for (std::uint64_t i = 4; i-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes[at + i]);
  return out;
}

}  // namespace

absl::StatusOr<FileMesh> read_binary_stl(std::string_view bytes, const std::string& file_name) {
  const auto refuse = [&](const std::string& what) {
    return absl::InvalidArgumentError(fmt::format("{}: {}", file_name, what));
  };
  if (bytes.size() < kStlHead)
    return refuse(fmt::format(
        "this is neither ASCII STL, which begins with \"solid\", nor binary STL, which has at "
        "least 84 bytes (this has {})",
        bytes.size()));
  // Text has no byte 0, which a count of facets below 16 million and round coordinates have.
  if (bytes.find('\0') == bytes.npos && bytes.find("facet") != bytes.npos)
    return refuse(fmt::format(
        "this is text that begins with \"{}\", and ASCII STL begins with \"solid\": delete what "
        "stands before it",
        one_line(bytes.substr(0, std::min<std::size_t>(bytes.find_first_of(" \r\n"), 20)))));
  const std::uint64_t facets = stl_word(bytes, 80), there = (bytes.size() - kStlHead) / kStlFacet;
  if (facets > there)
    return refuse(fmt::format(
        "this is no complete binary STL file: its header counts {} facets, and {} are there",
        facets, there));
  const std::string_view behind = bytes.substr(kStlHead + kStlFacet * facets);
  // Whole facets behind the last one are geometry that the count leaves out.
  if (!behind.empty() && behind.size() % kStlFacet == 0 &&
      std::ranges::any_of(behind, [](char c) { return c != '\0'; }))
    return refuse(fmt::format(
        "the header counts {} facets, and {} are there: export the file again", facets, there));
  FileMesh mesh;
  VertexMerger vertices(mesh);
  Float32Guard guard;
  for (std::uint64_t i = 0; i < facets; ++i) {
    std::array<Vec<FileFrame>, 3> corner;
    std::array<std::uint32_t, 3> number{};
    for (std::uint64_t j = 0; j < 3; ++j) {
      const auto value = [&](std::uint64_t axis) {
        return static_cast<double>(std::bit_cast<float>(
            stl_word(bytes, kStlHead + kStlFacet * i + 12 + 12 * j + 4 * axis)));
      };
      corner[j] = {value(0), value(1), value(2)};
      if (!std::isfinite(corner[j].x) || !std::isfinite(corner[j].y) || !std::isfinite(corner[j].z))
        return refuse(
            fmt::format("corner {} of facet {} (counted from 1) is not finite", j + 1, i + 1));
      number[j] = vertices.number(corner[j]);
    }
    guard.add(corner[0], corner[1], corner[2]);
    mesh.triangle.push_back(number);
  }
  if (const std::optional<std::string> coarse = guard.problem()) return refuse(*coarse);
  if (!mesh.triangle.empty()) mesh.group = {GroupTable::join({})};
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
  return mesh;
}

}  // namespace irsig
