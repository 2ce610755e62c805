#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/import/import_formats.h"
#include "core/scene/import/import_text.h"

namespace irsig {

struct PlyProperty {
  std::string name;
  bool is_list = false;
  int bytes = 0;  // the least that it takes in a binary file
  // Names of types; item_type: of a list's items, whose number has `type`.
  std::string type, item_type;
};
struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> property;  // never empty where count > 0
};
struct PlyHeader {
  enum class Form : std::uint8_t { kAscii, kLittleEndian, kBigEndian } form = Form::kAscii;
  [[nodiscard]] bool is_binary() const { return form != Form::kAscii; }
  std::size_t data_begin = 0;       // the first byte behind the header
  std::vector<PlyElement> element;  // with vertex.x, .y, .z and face.vertex_indices (or _index)
};

// Reads up to the end of the line end_header; what is missing or wrong goes to `errors`. `bytes`:
// the file that the cursor stands at the beginning of.
[[nodiscard]] PlyHeader read_ply_header(std::string_view bytes, TextCursor& cursor,
                                        FileErrors& errors);

// Reads what follows the header of a binary file. Vertices keep the file's order, as those of text
// do. An error names the element and its number.
[[nodiscard]] absl::StatusOr<FileMesh> read_binary_ply(std::string_view bytes,
                                                       const PlyHeader& header,
                                                       const std::string& file_name);

}  // namespace irsig
