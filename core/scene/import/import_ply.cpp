// PLY: elements and properties in any order; "vertex" needs x, y, z, "face" a list named
// vertex_indices or vertex_index; or "tristrips" such a list of strips, each ended by -1. Everything
// else is read over. Text is read here, in double.
#include <algorithm>

#include "core/scene/import/import_formats.h"
#include "core/scene/import/import_ply_header.h"
#include "fmt/format.h"

namespace irsig {
namespace {

class PlyReader {
 public:
  PlyReader(const TextCursor& behind_header, const std::string& file_name)
      : cursor_(behind_header), errors_(file_name) {}

  absl::StatusOr<FileMesh> read(const PlyHeader& header) {
    for (const PlyElement& element : header.element)
      for (std::int64_t i = 0; i < element.count && !errors_.any(); ++i) read_row(element);
    if (!errors_.any()) triangulate();
    if (errors_.any()) return errors_.status();
    if (!mesh_.triangle.empty()) mesh_.group = {"default"};
    return std::move(mesh_);
  }

 private:
  struct Polygon {
    Token where;
    std::vector<std::uint32_t> corner;
  };

  void read_row(const PlyElement& element) {
    Vec<FileFrame> at;
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face",
               is_strip = element.name == "tristrips";
    for (const PlyProperty& property : element.property) {
      const Token word = cursor_.word();
      if (property.is_list) {
        const bool corners = property.name == "vertex_indices" || property.name == "vertex_index";
        read_list(word, !corners   ? List::kOther
                        : is_face  ? List::kFace
                        : is_strip ? List::kStrips
                                   : List::kOther);
      } else {
        double ignored = 0;
        double& value = !is_vertex             ? ignored
                        : property.name == "x" ? at.x
                        : property.name == "y" ? at.y
                        : property.name == "z" ? at.z
                                               : ignored;
        if (&value != &ignored) {
          (void)coordinate_of(word, errors_, value);
        } else if (!number_of(word.text) && word.text.find('#') == word.text.npos) {
          // "1.#QNAN" and "-1.#IND" are numbers of old run-time libraries.
          add_at(errors_, word,
                 fmt::format("{}, expected {}.{}", word ? "this is not a number" : "the file ends",
                             element.name, property.name));
        }
      }
      if (errors_.any()) return;  // the following rows would be out of step
    }
    if (is_vertex) mesh_.vertex.push_back(at);
  }

  enum class List { kFace, kStrips, kOther };

  void read_list(const Token& count_word, List list) {
    const bool corners = list == List::kFace, strips = list == List::kStrips;
    const std::optional<std::int64_t> count = integer_of(count_word.text);
    if (!count || *count < 0 || (corners && *count < 3)) {
      add_at(errors_, count_word,
             corners ? "expected the number of the face's corners, at least 3"
                     : "expected the length of a list");
      return;
    }
    Polygon polygon{count_word, {}};
    for (std::int64_t i = 0; i < *count; ++i) {
      const Token word = cursor_.word();
      const std::optional<std::int64_t> index = integer_of(word.text);
      if (corners && (!index || *index < 0 || *index > std::int64_t{0xfffffffe})) {
        add_at(errors_, word, "expected the number of a vertex, counted from 0");
        return;
      }
      if (!word) {
        add_at(errors_, word, "the file ends in the middle of a list");
        return;
      }
      if (strips && (!index || *index < -1 || *index > std::int64_t{0xfffffffe})) {
        add_at(errors_, word, "expected the number of a vertex, counted from 0, or -1");
        return;
      }
      if (strips) {
        if (*index < 0) {
          add_strip(polygon);
          polygon = {word, {}};
        } else {
          polygon.corner.push_back(static_cast<std::uint32_t>(*index));
        }
      }
      if (corners) polygon.corner.push_back(static_cast<std::uint32_t>(*index));
    }
    if (corners) polygon_.push_back(std::move(polygon));
    if (strips) add_strip(polygon);
  }

  // Every second triangle of a strip is wound the other way. A repeated corner joins strips.
  void add_strip(const Polygon& strip) {
    for (std::size_t i = 0; i + 2 < strip.corner.size(); ++i) {
      const std::uint32_t a = strip.corner[i], b = strip.corner[i + 1], c = strip.corner[i + 2];
      if (a == b || b == c || c == a) continue;
      polygon_.push_back({strip.where, i % 2 == 0 ? std::vector{a, b, c} : std::vector{b, a, c}});
    }
  }

  void triangulate() {
    for (const Polygon& polygon : polygon_) {
      const std::uint32_t largest = *std::max_element(polygon.corner.begin(), polygon.corner.end());
      if (largest >= mesh_.vertex.size()) {
        add_at(errors_, polygon.where,
               fmt::format("vertex {} does not exist: the file has {} vertices, counted from 0",
                           largest, mesh_.vertex.size()));
      } else if (!add_polygon(polygon.corner, 0, mesh_)) {
        add_at(errors_, polygon.where,
               fmt::format("this face cannot be cut into triangles: it crosses "
                           "itself, or is concave with more than {} corners",
                           max_concave_corners));
      }
    }
  }

  TextCursor cursor_;
  FileErrors errors_;
  FileMesh mesh_;
  std::vector<Polygon> polygon_;
};

}  // namespace

absl::StatusOr<FileMesh> read_ply(std::string_view bytes, const std::string& file_name) {
  TextCursor cursor(bytes);
  FileErrors errors(file_name);
  const PlyHeader header = read_ply_header(bytes, cursor, errors);
  if (errors.any()) return errors.status();
  if (header.is_binary()) return read_binary_ply(bytes, header, file_name);
  return PlyReader(cursor, file_name).read(header);
}

}  // namespace irsig
