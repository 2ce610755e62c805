// Wavefront OBJ: v, f, g, o, usemtl. Free-form curves and surfaces are refused.
#include <algorithm>
#include <limits>

#include "core/scene/import/import_formats.h"
#include "fmt/format.h"

namespace irsig {
namespace {

// Statements that say nothing about the surface's shape or names.
bool is_ignored(std::string_view word) {
  static constexpr std::string_view words[] = {
      "vt",  "vn",    "vp",     "s",      "mg",       "l",        "p",          "mtllib",
      "lod", "bevel", "maplib", "usemap", "c_interp", "d_interp", "shadow_obj", "trace_obj"};
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

// Statements of free-form curves and surfaces: what they describe is no polygon.
bool is_free_form(std::string_view word) {
  static constexpr std::string_view words[] = {"cstype", "deg",  "bmat",  "step", "curv", "curv2",
                                               "surf",   "parm", "trim",  "hole", "scrv", "sp",
                                               "end",    "con",  "ctech", "stech"};
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file_name)
      : cursor_(text), errors_(file_name), groups_(mesh_) {}

  absl::StatusOr<FileMesh> read() {
    do {
      const Token word = cursor_.word_on_line();
      if (!word || word.text[0] == '#') continue;
      if (word.text == "v") {
        read_vertex(word);
      } else if (word.text == "f" || word.text == "fo") {
        read_face(word);
      } else if (word.text == "o") {
        object_ = cursor_.rest_of_line().text;
        named_ = false;
      } else if (word.text == "usemtl") {
        material_ = cursor_.rest_of_line().text;
        named_ = false;
      } else if (word.text == "g") {
        group_names_.clear();
        for (Token name = cursor_.word_on_line(); name; name = cursor_.word_on_line())
          group_names_.emplace_back(name.text);
        named_ = false;
      } else if (is_free_form(word.text)) {
        // The statements of a curve or surface follow each other: one error says it.
        if (!free_form_)
          add_at(errors_, word,
                 fmt::format("\"{}\" belongs to a free-form curve or surface, which is not read: "
                             "export the model as polygons",
                             word.text));
        free_form_ = true;
      } else if (!is_ignored(word.text)) {
        add_at(errors_, word,
               fmt::format("\"{}\" is not understood, expected v, f, g, o, usemtl, vt, "
                           "vn, s, mtllib or a comment",
                           word.text));
      }
    } while (!errors_.full() && cursor_.next_line());
    if (!errors_.any()) triangulate();
    if (errors_.any()) return errors_.status();
    return std::move(mesh_);
  }

 private:
  struct Polygon {
    std::size_t first;
    std::uint32_t corners, group;
    std::size_t line;
  };

  void read_vertex(const Token& keyword) {
    double value[3] = {0, 0, 0};
    int count = 0;
    for (Token word = cursor_.word_on_line(); word && word.text[0] != '#';
         word = cursor_.word_on_line()) {
      // A weight or a colour behind them may be anything, "nan" and "1.#QNAN" too.
      if (count < 3 && !coordinate_of(word, errors_, value[count])) return;
      ++count;
    }
    if (count != 3 && count != 4 && count != 6 && count != 7) {
      add_at(errors_, keyword,
             fmt::format("a vertex with {} numbers, expected x y z, with or without w or r g b",
                         count));
    }
    mesh_.vertex.push_back({value[0], value[1], value[2]});
  }

  // One corner: v, v/vt, v//vn or v/vt/vn; what follows v may be left empty.
  void read_corner(const Token& word) {
    std::string_view text = word.text;
    std::optional<std::int64_t> index;
    bool well_formed = true;
    for (int part = 0; well_formed; ++part) {
      const std::size_t slash = text.find('/');
      const std::string_view number = text.substr(0, slash);
      const std::optional<std::int64_t> value = integer_of(number);
      if (part == 0) index = value;
      well_formed = part < 3 && (value || (part > 0 && number.empty()));
      if (slash == text.npos) break;
      text.remove_prefix(slash + 1);
    }
    if (!well_formed || !index) {
      add_at(errors_, word,
             fmt::format("\"{}\" is no corner, expected v, v/vt, v//vn or v/vt/vn", word.text));
      corner_.push_back(0);
      return;
    }
    const std::int64_t count = static_cast<std::int64_t>(mesh_.vertex.size());
    const std::int64_t at = *index < 0 ? count + *index : *index - 1;
    if (*index == 0 || at < 0 || at >= std::int64_t{std::numeric_limits<std::uint32_t>::max()}) {
      add_at(errors_, word,
             fmt::format("vertex {} does not exist: {} vertices so far, counted from 1", *index,
                         count));
      corner_.push_back(0);
      return;
    }
    if (at >= count) ahead_.push_back({word, at});
    corner_.push_back(static_cast<std::uint32_t>(at));
  }

  void read_face(const Token& keyword) {
    const std::size_t first = corner_.size();
    for (Token word = cursor_.word_on_line(); word && word.text[0] != '#';
         word = cursor_.word_on_line())
      read_corner(word);
    const std::size_t corners = corner_.size() - first;
    if (corners < 3) {
      add_at(errors_, keyword, fmt::format("a face with {} corners, expected at least 3", corners));
      return;
    }
    if (!named_) {
      std::vector<std::string> names{object_};
      names.insert(names.end(), group_names_.begin(), group_names_.end());
      names.push_back(material_);
      current_ = groups_.number(GroupTable::join(names));
      named_ = true;
    }
    polygon_.push_back({first, static_cast<std::uint32_t>(corners), current_, keyword.line});
  }

  void triangulate() {
    for (const Ahead& ahead : ahead_) {
      if (ahead.index < static_cast<std::int64_t>(mesh_.vertex.size())) continue;
      add_at(errors_, ahead.where,
             fmt::format("vertex {} does not exist: the file has {} vertices", ahead.index + 1,
                         mesh_.vertex.size()));
    }
    if (errors_.any()) return;
    std::vector<std::uint32_t> corner;
    mesh_.triangle.reserve(polygon_.size());
    mesh_.triangle_group.reserve(polygon_.size());
    for (const Polygon& polygon : polygon_) {
      const auto begin = corner_.begin() + static_cast<std::ptrdiff_t>(polygon.first);
      corner.assign(begin, begin + polygon.corners);
      if (add_polygon(corner, polygon.group, mesh_)) continue;
      add_at(errors_, {{}, polygon.line, 1},
             fmt::format("this face cannot be cut into triangles: it crosses itself, or is "
                         "concave with more than {} corners",
                         max_concave_corners));
    }
  }

  struct Ahead {  // a corner that names a vertex further down
    Token where;
    std::int64_t index;
  };

  TextCursor cursor_;
  FileErrors errors_;
  FileMesh mesh_;
  GroupTable groups_;
  std::string object_, material_;
  std::vector<std::string> group_names_;
  bool free_form_ = false;
  bool named_ = false;  // current_ belongs to the names above
  std::uint32_t current_ = 0;
  std::vector<std::uint32_t> corner_;
  std::vector<Polygon> polygon_;
  std::vector<Ahead> ahead_;
};

}  // namespace

absl::StatusOr<FileMesh> read_obj(std::string_view text, const std::string& file_name) {
  return ObjReader(text, file_name).read();
}

}  // namespace irsig
