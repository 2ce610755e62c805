#include "core/base/file_errors.h"

#include "absl/strings/str_cat.h"
#include "core/base/printable.h"

namespace irsig {

void FileErrors::add(std::size_t line, std::size_t column, std::string_view what) {
  if (full()) return;
  found_.push_back({absl::StrCat(file_name_, ":", line, ":", column), "", one_line(what)});
}

absl::Status FileErrors::status() const {
  std::vector<Problem> found = found_;
  if (full())
    found.push_back({"", "", absl::StrCat(file_name_, ": too many errors, reading stopped")});
  return problem_status(found);
}

}  // namespace irsig
