#include "view/query/row_weights.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "core/base/csv_rows.h"
#include "core/base/file_errors.h"
#include "core/base/printable.h"
#include "core/base/user_file.h"
#include "core/geo/frames.h"

namespace irsig {
namespace {

const std::vector<std::string>& known_columns() {
  static const std::vector<std::string> names = {
      "season", "time_utc", "range_m", "aspect_azimuth_deg", "aspect_elevation_deg", "weight"};
  return names;
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& file) : rows_(text), errors_(file) {
    out_.file = file;
  }

  absl::StatusOr<RowWeights> read() {
    while (!errors_.full() && rows_.next()) {
      if (column_.empty()) {
        if (!read_header()) return errors_.status();
      } else {
        read_line();
      }
    }
    if (errors_.any()) return errors_.status();
    const bool any = std::any_of(out_.line.begin(), out_.line.end(),
                                 [](const RowWeights::Line& l) { return l.weight > 0; });
    if (!any)
      errors_.add(std::max<std::size_t>(rows_.line(), 1), 1, "no line has a weight above 0");
    if (errors_.any()) return errors_.status();
    return std::move(out_);
  }

 private:
  bool read_header() {
    for (const CsvCell& cell : rows_.cells()) {
      const std::string name(cell.text);
      const auto& known = known_columns();
      if (std::find(known.begin(), known.end(), name) == known.end())
        errors_.add(rows_.line(), cell.column,
                    fmt::format("unknown column \"{}\", expected {}", one_line(name),
                                fmt::join(known, ", ")));
      else if (!column_.try_emplace(name, cells_).second)
        errors_.add(rows_.line(), cell.column, fmt::format("column \"{}\" is there twice", name));
      ++cells_;
    }
    const auto has = [&](const char* name) { return column_.contains(name); };
    out_.of_aspects = has("aspect_azimuth_deg") && has("aspect_elevation_deg");
    out_.has_season = has("season");
    out_.has_time = has("time_utc");
    out_.has_range = has("range_m");
    const bool conditions = out_.has_season || out_.has_time || out_.has_range;
    const bool aspects = has("aspect_azimuth_deg") || has("aspect_elevation_deg");
    if (!errors_.any() && (!has("weight") || aspects != out_.of_aspects || aspects == conditions))
      errors_.add(rows_.line(), 1,
                  "expected the columns aspect_azimuth_deg, aspect_elevation_deg, weight, or "
                  "weight and some of season, time_utc, range_m");
    return !errors_.any();
  }

  void read_line() {
    const auto& cells = rows_.cells();
    if (cells.size() != cells_) {
      errors_.add(rows_.line(), 1, fmt::format("{} cells, expected {}", cells.size(), cells_));
      return;
    }
    RowWeights::Line line{rows_.line(), "", "", 0, 0, 0, 0};
    const auto text = [&](const char* name) {
      const auto at = column_.find(name);
      return at == column_.end() ? std::string() : std::string(cells[at->second].text);
    };
    const auto number = [&](const char* name, double least, double most) {
      const auto at = column_.find(name);
      if (at == column_.end()) return 0.0;
      const CsvCell& cell = cells[at->second];
      const auto value = finite_number(cell.text);
      if (!value || *value < least || *value > most)
        errors_.add(cell.line, cell.column,
                    fmt::format("{} \"{}\", expected a number from {:g} to {:g}", name,
                                one_line(cell.text), least, most));
      return value.value_or(0);
    };
    line.season = text("season");
    line.time_utc = text("time_utc");
    line.range_m = number("range_m", 0, 1e9);
    line.azimuth_deg = number("aspect_azimuth_deg", -360, 360);
    line.elevation_deg = number("aspect_elevation_deg", -90, 90);
    line.weight = number("weight", 0, 1e12);
    if (!out_.of_aspects &&
        !seen_.try_emplace(std::tuple(line.season, line.time_utc, line.range_m), line.line).second)
      errors_.add(line.line, 1,
                  fmt::format("the same place has a weight in line {}",
                              seen_.at(std::tuple(line.season, line.time_utc, line.range_m))));
    out_.line.push_back(std::move(line));
  }

  CsvRows rows_;
  FileErrors errors_;
  RowWeights out_;
  std::map<std::string, std::size_t> column_;
  std::size_t cells_ = 0;
  std::map<std::tuple<std::string, std::string, double>, std::size_t> seen_;
};

}  // namespace

absl::StatusOr<RowWeights> read_row_weights(const std::string& path) {
  const auto text = read_user_file(path, kMostTableBytes);
  if (!text.ok())
    return absl::InvalidArgumentError(
        fmt::format("{}:1:1: {}", path, std::string(text.status().message())));
  return Reader(*text, path).read();
}

std::vector<double> weights_of_aspects(const RowWeights& table, std::span<const AspectDeg> aspect) {
  std::vector<Vec<Body>> unit;
  for (const AspectDeg& a : aspect) unit.push_back(body_from_aspect(a.azimuth, a.elevation));
  std::vector<double> out(aspect.size(), 0.0);
  for (const RowWeights::Line& line : table.line) {
    const Vec<Body> where = body_from_aspect(line.azimuth_deg, line.elevation_deg);
    const auto nearest = std::max_element(
        unit.begin(), unit.end(),
        [&](const Vec<Body>& a, const Vec<Body>& b) { return dot(a, where) < dot(b, where); });
    out[static_cast<std::size_t>(nearest - unit.begin())] += line.weight;
  }
  return out;
}

absl::StatusOr<double> weight_of(const RowWeights& table, const StoredSignature& row) {
  for (const RowWeights::Line& line : table.line)
    if ((!table.has_season || line.season == row.season) &&
        (!table.has_time || line.time_utc == row.time_utc) &&
        (!table.has_range || std::abs(line.range_m - row.range_m) <= 1e-9 * row.range_m))
      return line.weight;
  std::string place;
  if (table.has_season) place += fmt::format(" season \"{}\"", row.season);
  if (table.has_time) place += fmt::format(" time_utc {}", row.time_utc);
  if (table.has_range) place += fmt::format(" range_m {:g}", row.range_m);
  return absl::InvalidArgumentError(
      fmt::format("{}: no line for{}; a weight of 0 leaves rows out", table.file, place));
}

}  // namespace irsig
