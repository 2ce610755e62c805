// Binary PLY: the elements of the header one after the other, without anything between them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/scene/import/import_formats.h"
#include "core/scene/import/import_ply_header.h"
#include "fmt/format.h"

namespace irsig {
namespace {

enum class PlyType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat,
  kDouble
};

PlyType ply_type(std::string_view name) {
  if (name == "char" || name == "int8") return PlyType::kInt8;
  if (name == "uchar" || name == "uint8") return PlyType::kUint8;
  if (name == "short" || name == "int16") return PlyType::kInt16;
  if (name == "ushort" || name == "uint16") return PlyType::kUint16;
  if (name == "int" || name == "int32") return PlyType::kInt32;
  if (name == "uint" || name == "uint32") return PlyType::kUint32;
  if (name == "float" || name == "float32") return PlyType::kFloat;
  return PlyType::kDouble;
}

std::size_t item_bytes(PlyType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

class BinaryPlyReader {
 public:
  BinaryPlyReader(std::string_view bytes, const PlyHeader& header, const std::string& file_name)
      : bytes_(bytes),
        at_(header.data_begin),
        big_endian_(header.form == PlyHeader::Form::kBigEndian),
        file_name_(file_name) {}

  absl::StatusOr<FileMesh> read(const PlyHeader& header) {
    for (const PlyElement& element : header.element)
      for (std::int64_t i = 0; i < element.count && problem_.empty(); ++i) read_row(element, i);
    if (problem_.empty()) triangulate();
    if (problem_.empty())
      if (const std::optional<std::string> coarse = guard_.problem(); coarse) problem_ = *coarse;
    if (!problem_.empty())
      return absl::InvalidArgumentError(fmt::format("{}: {}", file_name_, problem_));
    if (!mesh_.triangle.empty()) mesh_.group = {"default"};
    return std::move(mesh_);
  }

 private:
  // Faces in one list: where each one's corners end.
  struct Face {
    std::size_t end;
    std::uint64_t row;
  };

  double take(PlyType type, const PlyElement& element, std::int64_t row) {
    const std::size_t size = item_bytes(type);
    if (size > bytes_.size() - at_) {
      if (problem_.empty())
        problem_ = fmt::format("the file is cut short: it ends in {} {} of {} (counted from 0)",
                               element.name, row, element.count);
      return 0;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t from = big_endian_ ? i : size - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(bytes_[at_ + from]);
    }
    at_ += size;
    switch (type) {
      case PlyType::kInt8:
        return static_cast<std::int8_t>(bits);
      case PlyType::kInt16:
        return static_cast<std::int16_t>(bits);
      case PlyType::kInt32:
        return static_cast<std::int32_t>(bits);
      case PlyType::kFloat:
        return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
      case PlyType::kDouble:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  void read_row(const PlyElement& element, std::int64_t row) {
    Vec<FileFrame> at;
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face",
               is_strip = element.name == "tristrips";
    for (const PlyProperty& property : element.property) {
      const PlyType type = ply_type(property.type);
      const double value = take(type, element, row);
      if (property.is_list) {
        const bool corners = property.name == "vertex_indices" || property.name == "vertex_index";
        read_list(value, ply_type(property.item_type), element, row, corners && is_face,
                  corners && is_strip);
      } else if (is_vertex &&
                 (property.name == "x" || property.name == "y" || property.name == "z")) {
        (property.name == "x" ? at.x : property.name == "y" ? at.y : at.z) = value;
        is_float_ = is_float_ || type == PlyType::kFloat;
        if (!std::isfinite(value) && problem_.empty())
          problem_ =
              fmt::format("{} of vertex {} (counted from 0) is not finite", property.name, row);
      }
      if (!problem_.empty()) return;
    }
    if (is_vertex) mesh_.vertex.push_back(at);
  }

  void read_list(double length, PlyType type, const PlyElement& element, std::int64_t row,
                 bool is_face, bool is_strip) {
    const auto refuse = [&](std::string_view what) {
      if (problem_.empty())
        problem_ = fmt::format("{} {} (counted from 0) {}", element.name, row, what);
    };
    if (!(length >= (is_face ? 3 : 0) && length == std::floor(length)))
      return refuse(fmt::format("has a list of {} items, expected {}", length,
                                is_face ? "at least 3 corners" : "a whole number of them"));
    const std::size_t size = item_bytes(type);
    if (length > static_cast<double>((bytes_.size() - at_) / size)) {
      (void)take(PlyType::kUint8, element, row);
      return refuse(
          fmt::format("has {} items, which end behind the file: it is cut short", length));
    }
    if (!is_face && !is_strip) {
      at_ += static_cast<std::size_t>(length) * size;
      return;
    }
    strip_.clear();
    for (double i = 0; i < length && problem_.empty(); ++i) {
      const double index = take(type, element, row);
      if (is_strip && index == -1) {
        add_strip(static_cast<std::uint64_t>(row));
        continue;
      }
      if (!(index >= 0 && index <= 4294967294.0 && index == std::floor(index)))
        return refuse(fmt::format("names vertex {}, expected a number from 0", index));
      (is_face ? corner_ : strip_).push_back(static_cast<std::uint32_t>(index));
    }
    if (is_face) face_.push_back({corner_.size(), static_cast<std::uint64_t>(row)});
    if (is_strip) add_strip(static_cast<std::uint64_t>(row));
  }

  // Every second triangle of a strip is wound the other way. A repeated corner joins strips.
  void add_strip(std::uint64_t row) {
    for (std::size_t i = 0; i + 2 < strip_.size(); ++i) {
      const std::uint32_t a = strip_[i], b = strip_[i + 1], c = strip_[i + 2];
      if (a == b || b == c || c == a) continue;
      corner_.insert(corner_.end(), {i % 2 == 0 ? a : b, i % 2 == 0 ? b : a, c});
      face_.push_back({corner_.size(), row});
    }
    strip_.clear();
  }

  void triangulate() {
    std::vector<std::uint32_t> polygon;
    std::size_t begin = 0;
    for (const Face& face : face_) {
      polygon.assign(corner_.begin() + static_cast<std::ptrdiff_t>(begin),
                     corner_.begin() + static_cast<std::ptrdiff_t>(face.end));
      begin = face.end;
      const std::uint32_t largest = *std::ranges::max_element(polygon);
      if (largest >= mesh_.vertex.size()) {
        problem_ = fmt::format("face {} uses vertex {}, and the file has {} (both counted from 0)",
                               face.row, largest, mesh_.vertex.size());
        return;
      }
      const std::size_t before = mesh_.triangle.size();
      if (!add_polygon(polygon, 0, mesh_)) {
        problem_ = fmt::format(
            "face {} (counted from 0) cannot be cut into triangles: it crosses itself, or is "
            "concave with more than {} corners",
            face.row, max_concave_corners);
        return;
      }
      if (!is_float_) continue;
      for (std::size_t i = before; i < mesh_.triangle.size(); ++i) {
        const auto& t = mesh_.triangle[i];
        guard_.add(mesh_.vertex[t[0]], mesh_.vertex[t[1]], mesh_.vertex[t[2]]);
      }
    }
  }

  std::string_view bytes_;
  std::size_t at_;
  bool big_endian_, is_float_ = false;
  const std::string& file_name_;
  std::string problem_;
  FileMesh mesh_;
  Float32Guard guard_;
  std::vector<std::uint32_t> corner_, strip_;
  std::vector<Face> face_;
};

}  // namespace

absl::StatusOr<FileMesh> read_binary_ply(std::string_view bytes, const PlyHeader& header,
                                         const std::string& file_name) {
  return BinaryPlyReader(bytes, header, file_name).read(header);
}

}  // namespace irsig
