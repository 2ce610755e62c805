#include "planning/accuracy_source.h"

#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"

namespace irsig {
namespace {

bool is_database(const std::string& path) {
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  // An unreadable file counts as a sweep: reading it as a sweep reports the error.
  const absl::StatusOr<std::string> front = front_of_user_file(path, kMagic.size());
  return front.ok() && *front == kMagic;
}

// The one sweep of the database, or the one that is asked for.
absl::StatusOr<std::string> choose(StoreReader& reader, const std::string& path,
                                   const std::string& asked) {
  ASSIGN_OR_RETURN(const auto sweeps, reader.progress());
  std::vector<std::string> names;
  for (const SweepProgress& sweep : sweeps) names.push_back(sweep.name);
  if (names.empty()) return absl::InvalidArgumentError(absl::StrCat(path, " holds no sweep"));
  if (asked.empty() && names.size() == 1) return names.front();
  for (const std::string& name : names)
    if (name == asked) return name;
  return absl::InvalidArgumentError(absl::StrCat("--sweep", asked.empty() ? "" : " ", asked, ": ",
                                                 path, " holds the sweeps ",
                                                 absl::StrJoin(names, ", "), ": name one of them"));
}

}  // namespace

absl::StatusOr<AccuracySource> load_accuracy_source(const std::string& path,
                                                    const std::string& sweep_name) {
  AccuracySource out;
  if (!is_database(path)) {
    if (!sweep_name.empty())
      return absl::InvalidArgumentError(
          absl::StrCat("--sweep ", sweep_name, ": ", path, " is no database but one sweep"));
    ASSIGN_OR_RETURN(auto loaded, load_sweep(path, {}));
    out.loaded = std::move(loaded);
    return out;
  }
  ASSIGN_OR_RETURN(auto reader, StoreReader::open(path));
  ASSIGN_OR_RETURN(const auto name, choose(*reader, path, sweep_name));
  ASSIGN_OR_RETURN(auto stored, reader->sweep(name));
  // Errors about keys of the sweep say where it stands.
  out.loaded.file.file_name = path;
  out.loaded.file.sweep = stored.resolved.sweep();
  out.loaded.resolved = std::move(stored.resolved);
  out.loaded.assets = std::move(stored.assets);
  out.loaded.heat = std::move(stored.heat);
  out.database = std::move(reader);
  return out;
}

}  // namespace irsig
