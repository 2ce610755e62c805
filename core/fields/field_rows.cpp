#include "core/fields/field_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>

#include "core/base/csv_rows.h"
#include "core/geo/sun.h"
#include "core/scene/import/import_ply_header.h"
#include "fmt/format.h"
#include "fmt/ranges.h"

namespace irsig {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

class CsvReader {
 public:
  CsvReader(std::string_view text, const std::string& file_name)
      : rows_in_(text), errors_(file_name) {}

  absl::StatusOr<FieldRows> read() {
    while (!errors_.full() && rows_in_.next()) {
      line_ = rows_in_.line();
      if (column_.empty()) {
        read_header(rows_in_.cells());
        if (errors_.any()) break;
      } else {
        read_row(rows_in_.cells());
      }
    }
    line_ = rows_in_.line();
    if (!errors_.any() && column_.empty()) errors_.add(1, 1, "there is no header");
    if (!errors_.any() && rows_.row.empty()) errors_.add(line_, 1, "there are no values");
    if (errors_.any()) return errors_.status();
    return std::move(rows_);
  }

 private:
  void read_header(const std::vector<CsvCell>& cells) {
    // The last three are for people: `irsig export --temperatures` writes them.
    static const std::vector<std::string> known = {"facet",
                                                   "vertex",
                                                   "x",
                                                   "y",
                                                   "z",
                                                   "temperature",
                                                   "error",
                                                   "time",
                                                   "part",
                                                   "season",
                                                   "temperature_model_error_k"};
    for (const CsvCell& cell : cells) {
      const std::string name(cell.text);
      if (std::find(known.begin(), known.end(), name) == known.end())
        errors_.add(
            line_, cell.column,
            fmt::format("unknown column \"{}\", expected {}", name, fmt::join(known, ", ")));
      else if (!at_.try_emplace(name, column_.size()).second)
        errors_.add(line_, cell.column, fmt::format("column \"{}\" is there twice", name));
      column_.push_back(name);
    }
    if (errors_.any()) return;
    const bool place = at_.contains("x") && at_.contains("y") && at_.contains("z"),
               facet = at_.contains("facet"), vertex = at_.contains("vertex");
    if (!at_.contains("temperature")) errors_.add(line_, 1, "there is no column temperature");
    if (at_.contains("x") + at_.contains("y") + at_.contains("z") != (place ? 3 : 0))
      errors_.add(line_, 1, "places need x, y and z");
    if (facet && vertex) errors_.add(line_, 1, "there are both facet and vertex, expected one");
    if (!facet && !vertex && !place)
      errors_.add(line_, 1, "nothing says where a value is, expected facet, vertex or x, y, z");
    rows_.of = facet    ? FieldRows::Of::kFacet
               : vertex ? FieldRows::Of::kVertex
                        : FieldRows::Of::kPlace;
    rows_.has_index = facet || vertex;
    rows_.has_place = place;
    index_at_ = facet ? find("facet") : find("vertex");
    place_at_ = {find("x"), find("y"), find("z")};
    temperature_at_ = find("temperature");
    error_at_ = find("error");
    time_at_ = find("time");
  }

  void read_row(const std::vector<CsvCell>& cells) {
    if (cells.size() != column_.size()) {
      errors_.add(line_, cells.back().column,
                  fmt::format("{} cells, expected {}", cells.size(), column_.size()));
      return;
    }
    const auto number = [&](const char* name, std::optional<std::size_t> at, double absent) {
      if (!at) return absent;
      const CsvCell& cell = cells[*at];
      if (const std::optional<double> value = finite_number(cell.text)) return *value;
      errors_.add(line_, cell.column,
                  fmt::format("{} = \"{}\", expected a number", name, cell.text));
      return absent;
    };
    FieldRows::Row row;
    row.line = line_;
    if (index_at_) {
      const CsvCell& cell = cells[*index_at_];
      const std::optional<std::int64_t> index = integer_of(cell.text);
      if (!index || *index < 0)
        errors_.add(line_, cell.column,
                    fmt::format("{} = \"{}\", expected a whole number from 0", column_[*index_at_],
                                cell.text));
      else
        row.index = *index;
    }
    row.place = {number("x", place_at_[0], 0), number("y", place_at_[1], 0),
                 number("z", place_at_[2], 0)};
    row.temperature = number("temperature", temperature_at_, 0);
    row.error = number("error", error_at_, kNone);
    if (row.error < 0) errors_.add(line_, cells[*error_at_].column, "an error below 0");
    row.unix_s = time_at_ ? time_of(cells[*time_at_]) : kNone;
    rows_.row.push_back(row);
  }

  // Most rows have the time of the one before.
  double time_of(const CsvCell& cell) {
    if (cell.text == last_time_) return last_unix_s_;
    const auto time = parse_rfc3339(cell.text);
    if (!time.ok()) {
      errors_.add(line_, cell.column, std::string(time.status().message()));
      return kNone;
    }
    last_time_ = cell.text;
    return last_unix_s_ = unix_seconds(*time);
  }

  [[nodiscard]] std::optional<std::size_t> find(const char* name) const {
    const auto at = at_.find(name);
    return at == at_.end() ? std::nullopt : std::optional(at->second);
  }

  CsvRows rows_in_;
  FileErrors errors_;
  std::size_t line_ = 0;
  std::vector<std::string> column_;
  std::map<std::string, std::size_t> at_;
  std::optional<std::size_t> index_at_, temperature_at_, error_at_, time_at_;
  std::array<std::optional<std::size_t>, 3> place_at_;
  std::string last_time_;
  double last_unix_s_ = kNone;
  FieldRows rows_;
};

// Numbers of a PLY file one after the other, whatever its format.
class PlyNumbers {
 public:
  PlyNumbers(TextCursor& cursor, std::string_view bytes, const PlyHeader& header)
      : cursor_(cursor), form_(header.form) {
    if (form_ != PlyHeader::Form::kAscii) bytes_ = bytes.substr(header.data_begin);
  }

  [[nodiscard]] std::optional<double> next(std::string_view type) {
    if (form_ == PlyHeader::Form::kAscii) return number_of(cursor_.word().text);
    const auto as = [&](auto value) -> std::optional<double> {
      std::array<char, sizeof value> raw;
      if (bytes_.size() < raw.size()) return std::nullopt;
      std::memcpy(raw.data(), bytes_.data(), raw.size());
      bytes_.remove_prefix(raw.size());
      const bool big = form_ == PlyHeader::Form::kBigEndian;
      if (big != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
      std::memcpy(&value, raw.data(), raw.size());
      return static_cast<double>(value);
    };
    if (type == "char" || type == "int8") return as(std::int8_t{});
    if (type == "uchar" || type == "uint8") return as(std::uint8_t{});
    if (type == "short" || type == "int16") return as(std::int16_t{});
    if (type == "ushort" || type == "uint16") return as(std::uint16_t{});
    if (type == "int" || type == "int32") return as(std::int32_t{});
    if (type == "uint" || type == "uint32") return as(std::uint32_t{});
    if (type == "float" || type == "float32") return as(float{});
    return as(double{});
  }

 private:
  TextCursor& cursor_;
  PlyHeader::Form form_;
  std::string_view bytes_;
};

bool has_temperature(const PlyElement& element) {
  return std::any_of(element.property.begin(), element.property.end(),
                     [](const PlyProperty& p) { return p.name == "temperature" && !p.is_list; });
}

}  // namespace

absl::StatusOr<FieldRows> read_field_csv(std::string_view text, const std::string& file_name) {
  return CsvReader(text, file_name).read();
}

absl::StatusOr<FieldRows> read_field_ply(std::string_view bytes, const std::string& file_name) {
  TextCursor cursor(bytes);
  FileErrors errors(file_name);
  const PlyHeader header = read_ply_header(bytes, cursor, errors);
  if (errors.any()) return errors.status();
  const auto wrong = [&](std::string_view what) {
    return absl::InvalidArgumentError(fmt::format("{}: {}", file_name, what));
  };
  std::string of;
  for (const PlyElement& element : header.element) {
    if (!has_temperature(element)) continue;
    if (!of.empty())
      return wrong("both vertices and faces have a temperature, expected one of them");
    of = element.name;
  }
  if (of != "vertex" && of != "face")
    return wrong("neither vertices nor faces have a property temperature");
  FieldRows out;
  out.of = of == "face" ? FieldRows::Of::kFacet : FieldRows::Of::kVertex;
  out.has_index = out.has_place = true;
  PlyNumbers numbers(cursor, bytes, header);
  std::vector<std::array<double, 3>> vertex;
  for (const PlyElement& element : header.element)
    for (std::int64_t i = 0; i < element.count; ++i) {
      FieldRows::Row row{0, i, {}, 0, kNone, kNone};
      std::vector<double> corner;
      for (const PlyProperty& p : element.property) {
        const std::optional<double> value = numbers.next(p.type);
        const auto cut = [&] {
          return wrong(
              fmt::format("{} {} of {} has no {}: the file is cut short, or holds no number",
                          element.name, i, element.count, p.name));
        };
        // Colours and normals that are not finite are of no use here.
        const bool used = p.is_list || p.name == "x" || p.name == "y" || p.name == "z" ||
                          p.name == "temperature" || p.name == "error";
        if (!value || (used && !std::isfinite(*value))) return cut();
        if (p.is_list) {
          corner.clear();
          for (double k = 0; k < *value; ++k) {
            const std::optional<double> item = numbers.next(p.item_type);
            if (!item) return cut();
            corner.push_back(*item);
          }
          continue;
        }
        for (std::size_t axis = 0; axis < 3; ++axis)
          if (p.name == std::string(1, "xyz"[axis])) row.place[axis] = *value;
        if (p.name == "temperature") row.temperature = *value;
        if (p.name == "error") row.error = *value;
      }
      if (row.error < 0) return wrong(fmt::format("{} {} has an error below 0", element.name, i));
      if (element.name == "vertex") vertex.push_back(row.place);
      if (element.name == "face" && of == "face") {
        row.place = {};
        for (const double c : corner) {
          if (!(c >= 0 && c < static_cast<double>(vertex.size())))
            return wrong(fmt::format("face {} refers to vertex {} of {}", i, c, vertex.size()));
          for (std::size_t axis = 0; axis < 3; ++axis)
            row.place[axis] +=
                vertex[static_cast<std::size_t>(c)][axis] / static_cast<double>(corner.size());
        }
      }
      if (element.name == of) out.row.push_back(row);
    }
  if (out.row.empty()) return wrong("there are no values");
  return out;
}

}  // namespace irsig
