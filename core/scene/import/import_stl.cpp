// ASCII STL: any number of solids, each a group. The winding says which side is outside; the
// normals of the file, often wrong or nan, are read over.
#include <array>

#include "core/scene/import/import_formats.h"
#include "fmt/format.h"

namespace irsig {
namespace {

class StlReader {
 public:
  StlReader(std::string_view text, const std::string& file_name)
      : cursor_(text), errors_(file_name), groups_(mesh_), vertices_(mesh_) {}

  absl::StatusOr<FileMesh> read() {
    for (Token word = cursor_.word(); word && !errors_.any(); word = cursor_.word()) {
      if (!is(word, "solid")) continue;
      const std::string name(cursor_.rest_of_line().text);
      read_solid(GroupTable::join({name}));
    }
    if (errors_.any()) return errors_.status();
    return std::move(mesh_);
  }

 private:
  bool is(const Token& word, std::string_view expected) {
    if (equals_ignoring_case(word.text, expected)) return true;
    add_at(errors_, word,
           word ? fmt::format("\"{}\", expected \"{}\"", word.text, expected)
                : fmt::format("the file ends, expected \"{}\"", expected));
    return false;
  }

  void read_solid(const std::string& name) {
    for (;;) {
      const Token word = cursor_.word();
      if (equals_ignoring_case(word.text, "endsolid")) {
        (void)cursor_.rest_of_line();
        return;
      }
      if (!word) {
        add_at(errors_, word,
               "the file ends without \"endsolid\": it may be cut short, export it again");
        return;
      }
      if (!is(word, "facet") || !read_facet(name)) return;
    }
  }

  // A broken facet leaves the reader without a place to go on: its error is the only one.
  bool read_facet(const std::string& name) {
    if (!is(cursor_.word(), "normal")) return false;
    for (int i = 0; i < 3; ++i) {
      // Any word: old run-time libraries write "1.#QNAN" for the normal of a sliver.
      const Token word = cursor_.word();
      if (word && !equals_ignoring_case(word.text, "outer")) continue;
      add_at(errors_, word, fmt::format("\"{}\", expected a number of the normal", word.text));
      return false;
    }
    if (!is(cursor_.word(), "outer") || !is(cursor_.word(), "loop")) return false;
    std::array<std::uint32_t, 3> corner{};
    for (std::uint32_t& index : corner) {
      Vec<FileFrame> at;
      if (!is(cursor_.word(), "vertex")) return false;
      for (double* value : {&at.x, &at.y, &at.z})
        if (!coordinate_of(cursor_.word(), errors_, *value)) return false;
      index = vertices_.number(at);
    }
    if (!is(cursor_.word(), "endloop") || !is(cursor_.word(), "endfacet")) return false;
    mesh_.triangle.push_back(corner);
    mesh_.triangle_group.push_back(groups_.number(name));
    return true;
  }

  TextCursor cursor_;
  FileErrors errors_;
  FileMesh mesh_;
  GroupTable groups_;
  VertexMerger vertices_;
};

}  // namespace

absl::StatusOr<FileMesh> read_ascii_stl(std::string_view text, const std::string& file_name) {
  return StlReader(text, file_name).read();
}

}  // namespace irsig
