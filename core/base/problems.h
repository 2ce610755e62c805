#pragma once

#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace irsig {

// A problem of a user's input and its place. A status carries its problems beside its message
// (problem_status, problems_of). Code that adds a place, a key or a prefix takes the problems from
// the status; no code searches the text of a message.
struct Problem {
  std::string place;  // "file:line:column"; empty: not known
  std::string key;    // by its path in the sweep file: "part[2].name"; empty: none
  std::string text;   // names the key where there is one
};

// Returns INVALID_ARGUMENT with a line "place: text" for each problem, or OK without problems.
[[nodiscard]] absl::Status problem_status(const std::vector<Problem>& problems);

// Returns the status of one problem: "place: text", or "key: what".
[[nodiscard]] absl::Status placed_problem(const std::string& place, absl::string_view text);
[[nodiscard]] absl::Status keyed_problem(const std::string& key, absl::string_view what);

// Returns the problems of a status, in their order: none of OK; of a status that was not made here
// a single one, whose text is the message.
[[nodiscard]] std::vector<Problem> problems_of(const absl::Status& status);

// Says at which key of the sweep a status arose: "key: " stands before each problem, whose places
// (of another file) become part of its text. The code stays.
[[nodiscard]] absl::Status at_key(const std::string& key, const absl::Status& status);

// Returns true if the message begins with a place in a file.
[[nodiscard]] bool begins_with_place(const absl::Status& status);

// Collects the problems of several readers.
class Problems {
 public:
  void add(Problem problem) { found_.push_back(std::move(problem)); }
  void add(const absl::Status& status);
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] absl::Status status() const { return problem_status(found_); }

 private:
  std::vector<Problem> found_;
};

}  // namespace irsig
