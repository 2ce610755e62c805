#include "jobs/files/weather_files.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/atmosphere/air_profile.h"
#include "core/atmosphere/imported/imported_path.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/thermal/weather_file.h"
#include "jobs/files/condition_table.h"
#include "jobs/text/section_check.h"

namespace irsig {
namespace {

// The text becomes part of every condition of its season.
constexpr std::size_t kMostBytes = 8000000;

class Reader {
 public:
  Reader(SweepFile& file, const FileReader& read) : file_(file), read_(read) {}

  void profile(const std::string& path, const std::string& name) {
    if (!take(path, name)) return;
    const std::string& text = file_.content[path];
    // Errors in the file do not depend on the air above its last level.
    const auto parsed =
        parse_profile_csv(text, one_line(name), afgl_profile(AfglProfile::kUsStandard1976));
    if (!parsed.ok()) wrong_.add(parsed.status());
  }

  // Reads a file of hours or years of weather once, however many seasons name it.
  void weather(const std::string& path, const std::string& name) {
    const std::string key = weather_file_key(name);
    if (!named_.insert(key).second || !take(path, name)) return;
    file_.content[key] = std::move(file_.content[path]);
    file_.content.erase(path);
    const auto parsed = read_weather_file(file_.content[key], one_line(name));
    if (!parsed.ok()) wrong_.add(parsed.status());
  }

  void text(const std::string& path, const std::string& name) { (void)take(path, name); }

  void paths(const std::string& path, const std::string& name) {
    if (!take(path, name)) return;
    const std::string& text = file_.content[path];
    const auto parsed = parse_imported_paths(text, one_line(name));
    if (!parsed.ok()) wrong_.add(parsed.status());
  }

  [[nodiscard]] absl::Status status() const { return wrong_.status(); }

 private:
  bool take(const std::string& path, const std::string& name) {
    const absl::StatusOr<std::string> bytes = read_(name);
    std::string wrong;
    if (!bytes.ok()) {
      wrong = std::string(bytes.status().message());
    } else if (bytes->empty()) {
      wrong = "is empty";
    } else if (bytes->size() > kMostBytes) {
      wrong = absl::StrCat("has ", bytes->size(), " bytes, expected at most ", kMostBytes);
    }
    if (wrong.empty()) {
      file_.content[path] = *bytes;
    } else {
      wrong_.add(placed_problem(file_.location(path),
                                absl::StrCat(path, " = \"", one_line(name), "\": ", wrong)));
    }
    return wrong.empty();
  }

  SweepFile& file_;
  const FileReader& read_;
  Problems wrong_;
  std::set<std::string> named_;
};

}  // namespace

std::string weather_file_key(const std::string& weather_file) {
  return "weather_file " + weather_file;
}

absl::Status read_weather_files(SweepFile& file, const FileReader& read) {
  Reader reader(file, read);
  if (file.sweep.has_condition_file()) {
    reader.text("condition_file", file.sweep.condition_file());
    if (!reader.status().ok()) return reader.status();
  }
  RETURN_IF_ERROR(expand_conditions(file));
  if (file.sweep.air().has_profile_file())
    reader.profile("air.profile_file", file.sweep.air().profile_file());
  for (int i = 0; i < file.sweep.season_size(); ++i) {
    const schema::Season& season = file.sweep.season(i);
    const std::string path = absl::StrCat("season[", i, "].");
    if (season.has_profile_file()) reader.profile(path + "profile_file", season.profile_file());
    if (season.has_weather_file()) reader.weather(path + "weather_file", season.weather_file());
    if (season.has_modtran_file()) reader.paths(path + "modtran_file", season.modtran_file());
  }
  return reader.status();
}

}  // namespace irsig
