#include "jobs/files/response_file.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/user_file.h"
#include "core/materials/optical/csv_columns.h"
#include "core/materials/optical/text_table.h"

namespace irsig {

absl::StatusOr<std::vector<SpectralPoint>> read_response(const std::string& path,
                                                         const std::string& value) {
  const auto text = read_user_file(path, kMostTableBytes);
  if (!text.ok()) return placed_problem(path + ":1:1", text.status().message());
  TableErrors errors(path);
  const NumberTable table = read_number_table(*text, errors);
  if (!errors.empty()) return errors.status();
  const auto& head = table.column;
  const auto unit_um = micrometres_in(head[0].text);
  if (head.size() != 2 || !unit_um || head[1].text != value) {
    errors.add(head.front().line, head.front().column,
               absl::StrCat("the columns are not those of a response, expected lambda_um,", value,
                            " (or lambda_nm)"));
    return errors.status();
  }
  check_wavelengths(table.row, errors);
  bool any = false;
  for (const auto& row : table.row) {
    if (row[1].value < 0)
      errors.add(row[1], absl::StrCat(value, " = ", row[1].value, ", expected 0 or more"));
    any |= row[1].value > 0;
  }
  if (table.row.size() < 2)
    errors.add(table.row.front().front(), "one wavelength is no response, expected two or more");
  else if (!any)
    errors.add(table.row.front().front(), absl::StrCat(value, " is 0 everywhere"));
  if (!errors.empty()) return errors.status();
  std::vector<SpectralPoint> out;
  for (const auto& row : table.row) out.push_back({row[0].value * *unit_um, row[1].value});
  return out;
}

}  // namespace irsig
