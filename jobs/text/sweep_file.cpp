#include "jobs/text/sweep_file.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace irsig {

std::string SweepFile::location(std::string_view path) const {
  std::string place(path);
  while (!place.empty()) {
    if (const auto found = where.find(place); found != where.end()) return found->second;
    const std::size_t cut = place.find_last_of(".[");
    if (cut == std::string::npos) break;
    place.resize(cut);
  }
  return absl::StrCat(file_name, ":1:1");
}

std::string SweepFile::as_written(const std::string& message) const {
  return absl::StrReplaceAll(message, written_as);
}

absl::Status located(const SweepFile& file, const absl::Status& status) {
  if (!absl::IsInvalidArgument(status)) return status;
  std::vector<Problem> problems = problems_of(status);
  for (Problem& problem : problems) {
    if (problem.place.empty()) problem.place = file.location(problem.key);
    problem.text = file.as_written(problem.text);
  }
  return problem_status(problems);
}

}  // namespace irsig
