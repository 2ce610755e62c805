#include "jobs/files/temperature_files.h"

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "jobs/text/section_check.h"

namespace irsig {
namespace {

std::string path_of(int field) { return absl::StrCat("temperature_field[", field, "].file"); }

}  // namespace

absl::Status read_temperature_files(SweepFile& file, const FileReader& read) {
  Problems wrong;
  for (int i = 0; i < file.sweep.temperature_field_size(); ++i) {
    const std::string &name = file.sweep.temperature_field(i).file(), path = path_of(i);
    if (name.empty()) continue;  // reported with what else is missing
    auto bytes = read(name);
    if (bytes.ok() && !bytes->empty())
      file.content[path] = *std::move(bytes);
    else
      wrong.add(placed_problem(
          file.location(path),
          absl::StrCat(path, " = \"", one_line(name),
                       "\": ", bytes.ok() ? "is empty" : std::string(bytes.status().message()))));
  }
  return wrong.status();
}

std::map<std::string, std::string_view> fields_of(const SweepFile& file) {
  std::map<std::string, std::string_view> out;
  for (int i = 0; i < file.sweep.temperature_field_size(); ++i) {
    const auto at = file.content.find(path_of(i));
    if (at != file.content.end()) out[file.sweep.temperature_field(i).name()] = at->second;
  }
  return out;
}

}  // namespace irsig
