#include "core/land/objects/read_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/base/csv_rows.h"
#include "core/base/file_errors.h"
#include "core/base/printable.h"

namespace irsig {
namespace {

constexpr std::array<const char*, 4> kColumn = {"east_m", "north_m", "heading_deg", "scale"};
constexpr std::size_t kEast = 0, kNorth = 1, kHeading = 2, kScale = 3;
constexpr double kFarthestM = 4e5;  // the corner of the widest map, and more
constexpr double kLargestScale = 1000;

using Columns = std::array<std::optional<std::size_t>, kColumn.size()>;

Columns columns_of(const std::vector<CsvCell>& cells, FileErrors& errors) {
  Columns out;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto at = std::find(kColumn.begin(), kColumn.end(), cells[i].text);
    const auto column = static_cast<std::size_t>(at - kColumn.begin());
    if (at == kColumn.end())
      errors.add(cells[i].line, cells[i].column,
                 absl::StrCat("column \"", one_line(std::string(cells[i].text)),
                              "\" is unknown, expected east_m, north_m, heading_deg or scale"));
    else if (out[column])
      errors.add(cells[i].line, cells[i].column,
                 absl::StrCat("column ", *at, " stands twice, expected each once"));
    else
      out[column] = i;
  }
  for (const std::size_t needed : {kEast, kNorth})
    if (!out[needed])
      errors.add(cells.front().line, 1,
                 absl::StrCat("column ", kColumn[needed],
                              " is missing, expected a first line with east_m,north_m and, if "
                              "needed, heading_deg and scale"));
  return out;
}

}  // namespace

absl::StatusOr<std::vector<ObjectPlace>> read_places(std::string_view text,
                                                     std::string_view file_name, double scale) {
  FileErrors errors(file_name);
  CsvRows rows(text);
  if (!rows.next()) {
    errors.add(1, 1, "the file is empty, expected a line east_m,north_m and a line for each place");
    return errors.status();
  }
  const std::size_t width = rows.cells().size();
  const Columns columns = columns_of(rows.cells(), errors);
  if (errors.any()) return errors.status();
  std::vector<ObjectPlace> out;
  while (!errors.full() && rows.next()) {
    const std::vector<CsvCell>& cells = rows.cells();
    if (cells.size() != width) {
      errors.add(rows.line(), 1,
                 absl::StrCat("the line has ", cells.size(), " cells, expected ", width));
      continue;
    }
    if (out.size() == kMostLandObjects) {
      errors.add(rows.line(), 1,
                 absl::StrCat("the file has more than ", kMostLandObjects,
                              " places, which is the limit; leave out what the sensor does not "
                              "resolve, or join objects in one mesh"));
      break;
    }
    ObjectPlace place;
    place.scale = scale;
    place.line = static_cast<std::uint32_t>(rows.line());
    const auto take = [&](std::size_t which, double least, double most, double& number) {
      if (!columns[which]) return;
      const CsvCell& cell = cells[*columns[which]];
      const auto value = finite_number(cell.text);
      if (value && *value >= least && *value <= most)
        number = *value;
      else
        errors.add(cell.line, cell.column,
                   absl::StrCat(kColumn[which], " = \"", one_line(std::string(cell.text)),
                                "\", expected a number from ", least, " to ", most));
    };
    take(kEast, -kFarthestM, kFarthestM, place.x_m);
    take(kNorth, -kFarthestM, kFarthestM, place.y_m);
    take(kHeading, -360, 360, place.heading_deg);
    take(kScale, 1 / kLargestScale, kLargestScale, place.scale);
    out.push_back(place);
  }
  if (!errors.any() && out.empty())
    errors.add(rows.line() + 1, 1, "the file has no places, expected a line for each");
  if (errors.any()) return errors.status();
  return out;
}

}  // namespace irsig
