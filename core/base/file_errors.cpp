#include "core/base/file_errors.h"

#include "absl/strings/str_cat.h"
#include "core/base/printable.h"

namespace irsig {

void FileErrors::add(std::size_t line, std::size_t column, std::string_view what) {
  if (full()) return;
  absl::StrAppend(&text_, any() ? "\n" : "", file_name_, ":", line, ":", column, ": ",
                  one_line(what));
  ++count_;
}

absl::Status FileErrors::status() const {
  if (!any()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      full() ? absl::StrCat(text_, "\n", file_name_, ": too many errors, reading stopped") : text_);
}

}  // namespace irsig
