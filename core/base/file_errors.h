#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace irsig {

// Collects what is wrong with a user's file, so that more than the first mistake is reported. More
// than ten say nothing new.
class FileErrors {
 public:
  explicit FileErrors(std::string_view file_name) : file_name_(file_name) {}

  // line, column: from 1. what: may quote the file, whatever stands there; it becomes one line.
  void add(std::size_t line, std::size_t column, std::string_view what);
  [[nodiscard]] bool any() const { return count_ > 0; }
  [[nodiscard]] bool full() const { return count_ >= 10; }
  // INVALID_ARGUMENT, a line "file:line:column: ..." for each; OK if there are none.
  [[nodiscard]] absl::Status status() const;

 private:
  std::string file_name_, text_;
  int count_ = 0;
};

}  // namespace irsig
