#include "core/scene/import/import_ply_header.h"

#include <algorithm>
#include <utility>

#include "fmt/format.h"

namespace irsig {
namespace {

// 0: no type.
int bytes_of(std::string_view type) {
  static constexpr std::pair<std::string_view, int> types[] = {
      {"char", 1},  {"uchar", 1},  {"short", 2},   {"ushort", 2}, {"int", 4},   {"uint", 4},
      {"float", 4}, {"double", 8}, {"int8", 1},    {"uint8", 1},  {"int16", 2}, {"uint16", 2},
      {"int32", 4}, {"uint32", 4}, {"float32", 4}, {"float64", 8}};
  for (const auto& [name, bytes] : types)
    if (name == type) return bytes;
  return 0;
}

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, TextCursor& cursor, FileErrors& errors)
      : bytes_(bytes), cursor_(cursor), errors_(errors) {}

  PlyHeader read() {
    const Token magic = cursor_.word_on_line();
    if (magic.text != "ply") add_at(errors_, magic, "expected \"ply\"");
    while (!errors_.full() && cursor_.next_line()) {
      const Token word = cursor_.word_on_line();
      if (word.text == "end_header") {
        check(word);
        header_.data_begin = behind(word.text);
        return std::move(header_);
      }
      if (word.text == "format") {
        read_format();
      } else if (word.text == "element") {
        read_element();
      } else if (word.text == "property") {
        read_property(word);
      } else if (word && word.text != "comment" && word.text != "obj_info") {
        add_at(errors_, word,
               fmt::format("\"{}\" in the header, expected format, comment, obj_info, "
                           "element, property or end_header",
                           word.text));
      }
    }
    add_at(errors_, cursor_.word_on_line(), "the file ends, expected end_header");
    return std::move(header_);
  }

 private:
  // Behind the line's end as the header's first line has it: data may begin with any byte, that of
  // a line's end too.
  std::size_t behind(std::string_view end_header) const {
    std::size_t at = static_cast<std::size_t>(end_header.data() - bytes_.data()) + end_header.size();
    const std::size_t first = std::min(bytes_.find_first_of("\r\n"), bytes_.size());
    const std::string_view line_end =
        bytes_.substr(first, 2) == "\r\n" ? bytes_.substr(first, 2) : bytes_.substr(first, 1);
    while (at < bytes_.size() && (bytes_[at] == ' ' || bytes_[at] == '\t')) ++at;
    if (bytes_.substr(at, line_end.size()) == line_end) return at + line_end.size();
    return std::min(at + 1, bytes_.size());
  }

  void read_format() {
    const Token form = cursor_.word_on_line();
    has_format_ = true;
    if (form.text == "binary_little_endian")
      header_.form = PlyHeader::Form::kLittleEndian;
    else if (form.text == "binary_big_endian")
      header_.form = PlyHeader::Form::kBigEndian;
    else if (form.text != "ascii")
      add_at(errors_, form, "expected format ascii, binary_little_endian or binary_big_endian");
  }

  void read_element() {
    const Token name = cursor_.word_on_line(), count = cursor_.word_on_line();
    const std::optional<std::int64_t> value = integer_of(count.text);
    if (!name || !value || *value < 0 || *value > std::int64_t{0xfffffffe})
      add_at(errors_, count, "expected: element NAME COUNT");
    else
      header_.element.push_back({std::string(name.text), *value, {}});
  }

  void read_property(const Token& keyword) {
    Token type = cursor_.word_on_line(), item = type;
    const bool is_list = type.text == "list";
    if (is_list) {
      type = cursor_.word_on_line();
      item = cursor_.word_on_line();
    }
    const Token name = cursor_.word_on_line();
    if (header_.element.empty()) {
      add_at(errors_, keyword, "a property before the first element");
    } else if (bytes_of(type.text) == 0 || bytes_of(item.text) == 0 || !name) {
      add_at(errors_, bytes_of(type.text) == 0 ? type : item,
             "expected: property TYPE NAME or property list TYPE TYPE NAME");
    } else {
      header_.element.back().property.push_back({std::string(name.text), is_list,
                                                 bytes_of(type.text), std::string(type.text),
                                                 std::string(item.text)});
    }
  }

  bool has(std::string_view element, std::string_view property, bool is_list) const {
    for (const PlyElement& e : header_.element)
      for (const PlyProperty& p : e.property)
        if (e.name == element && p.name == property && p.is_list == is_list) return true;
    return false;
  }

  bool has_corners(std::string_view element) const {
    return has(element, "vertex_indices", true) || has(element, "vertex_index", true);
  }

  void check(const Token& end) {
    if (!has_format_) add_at(errors_, end, "the header has no format");
    for (const std::string_view name : {"x", "y", "z"}) {
      if (!has("vertex", name, false))
        add_at(errors_, end, fmt::format("the element vertex has no property {}", name));
    }
    if (!has_corners("face") && !has_corners("tristrips"))
      add_at(errors_, end,
             "neither an element face nor an element tristrips has a property list vertex_indices");
    // Without properties a row takes no text, and a false count would never end.
    for (const PlyElement& e : header_.element) {
      if (e.property.empty() && e.count > 0)
        add_at(errors_, end, fmt::format("the element {} has no properties", e.name));
    }
  }

  std::string_view bytes_;
  TextCursor& cursor_;
  FileErrors& errors_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

PlyHeader read_ply_header(std::string_view bytes, TextCursor& cursor, FileErrors& errors) {
  return HeaderReader(bytes, cursor, errors).read();
}

}  // namespace irsig
