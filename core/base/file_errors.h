#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "core/base/problems.h"

namespace irsig {

// Collects what is wrong with a user's file, so that more than the first mistake is reported. More
// than ten say nothing new.
class FileErrors {
 public:
  explicit FileErrors(std::string_view file_name) : file_name_(file_name) {}

  // Adds an error at a line and column, both from 1. `what` may quote the file and becomes one
  // line.
  void add(std::size_t line, std::size_t column, std::string_view what);
  [[nodiscard]] bool any() const { return !found_.empty(); }
  [[nodiscard]] bool full() const { return found_.size() >= 10; }
  // Returns INVALID_ARGUMENT with a problem (problems.h) for each error, or OK without errors.
  [[nodiscard]] absl::Status status() const;

 private:
  std::string file_name_;
  std::vector<Problem> found_;
};

}  // namespace irsig
