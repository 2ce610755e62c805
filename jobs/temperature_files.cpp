#include "jobs/temperature_files.h"

#include "absl/strings/str_cat.h"
#include "jobs/section_check.h"

namespace irsig {
namespace {

std::string path_of(int field) { return absl::StrCat("temperature_field[", field, "].file"); }

}  // namespace

absl::Status read_temperature_files(SweepFile& file, const FileReader& read) {
  std::string wrong;
  for (int i = 0; i < file.sweep.temperature_field_size(); ++i) {
    const std::string &name = file.sweep.temperature_field(i).file(), path = path_of(i);
    if (name.empty()) continue;  // reported with what else is missing
    auto bytes = read(name);
    if (bytes.ok() && !bytes->empty())
      file.content[path] = *std::move(bytes);
    else
      absl::StrAppend(&wrong, wrong.empty() ? "" : "\n", file.location(path), ": ", path, " = \"",
                      one_line(name),
                      "\": ", bytes.ok() ? "is empty" : std::string(bytes.status().message()));
  }
  return wrong.empty() ? absl::OkStatus() : absl::InvalidArgumentError(wrong);
}

std::string field_bytes(const SweepFile& file, const std::string& name) {
  for (int i = 0; i < file.sweep.temperature_field_size(); ++i) {
    if (file.sweep.temperature_field(i).name() != name) continue;
    const auto at = file.content.find(path_of(i));
    return at == file.content.end() ? std::string() : at->second;
  }
  return "";
}

}  // namespace irsig
