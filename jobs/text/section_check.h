#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/base/formula.h"
#include "core/base/printable.h"
#include "core/base/problems.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

// The errors found in one sweep file. Each is kept with the place of its key, so that all errors
// are reported together, in the order of the file. In a sweep without a file (an empty SweepFile)
// errors name the field's path alone, and errors after the twentieth are counted.
class Findings {
 public:
  explicit Findings(const SweepFile& file) : file_(file) {}

  void add(const std::string& path, const std::string& what);
  // Adds a finding at "file:line:column", for a place that belongs to no key of the sweep file.
  void add_at(const std::string& place, const std::string& what);
  // Remembers the key of a possible but odd value, and returns a line for a warning about it.
  std::string odd(const std::string& key, const std::string& what);
  // Returns the key of a line that odd() returned; empty for other lines.
  [[nodiscard]] std::string key_of_odd(const std::string& warning) const;
  [[nodiscard]] bool empty() const { return found_.empty(); }
  // Returns true if there is a finding at the path itself, or in the table at the path.
  [[nodiscard]] bool any_at(const std::string& path) const;
  [[nodiscard]] std::size_t count() const { return found_.size(); }
  // Returns OK if there are no errors; otherwise INVALID_ARGUMENT with a problem
  // (core/base/problems.h) for each error.
  [[nodiscard]] absl::Status status() const;

 private:
  void add(Problem problem);

  const SweepFile& file_;
  std::vector<Problem> found_;
  std::size_t more_ = 0;
  std::set<std::string> at_;                // the paths
  std::map<std::string, std::string> odd_;  // the keys by the lines
};

// The checks that every table of a sweep file needs, on one message and by field names. An absent
// value passes every check except require(), so that each error is reported once.
class SectionCheck {
 public:
  using Names = std::vector<const char*>;

  SectionCheck(const google::protobuf::Message& section, std::string path, Findings& findings)
      : section_(section), path_(std::move(path)), findings_(findings) {}

  [[nodiscard]] bool has(const char* name) const;
  [[nodiscard]] std::string path(const std::string& name) const;
  void error(const char* name, const std::string& what) const;  // "<path> <what>" at the key
  void error_at(const std::string& key, const std::string& what) const;  // the same: "only[1]"

  // Reports missing keys as errors. `why` ends the sentence: "place.latitude_deg is missing,
  // <why>".
  void require(const Names& names, const std::string& why) const;
  // Reports other keys than these as errors: "<path> does not apply <why>".
  void only(const Names& names, const std::string& why) const;
  // Returns the number of the names that are present; more than one is an error.
  [[nodiscard]] int at_most_one(const Names& names) const;
  // Checks numbers whose limits depend on other keys, limits included (jobs/text/number_bounds.h
  // has all other limits). A number outside its own bounds is already reported.
  void within(const char* name, double least, double most) const;
  [[nodiscard]] bool one_of(const char* name,
                            const Names& choices) const;  // true: present and known

 private:
  [[nodiscard]] double number(const char* name) const;

  const google::protobuf::Message& section_;
  std::string path_;
  Findings& findings_;
};

inline constexpr const char* kFormulaName =
    "spreadsheets run a text that begins with =, +, - or @, expected a letter or a digit first";

// Checks names of parts, seasons, bands ...: present, printable and different from each other.
// Returns them in order.
template <typename Repeated>
std::vector<std::string> check_names(const Repeated& sections, const std::string& key,
                                     Findings& findings) {
  std::vector<std::string> names;
  std::map<std::string, int> seen;
  for (int i = 0; i < sections.size(); ++i) {
    const std::string path = key + "[" + std::to_string(i) + "]";
    const std::string& name = sections[i].name();
    if (!sections[i].has_name() || name.empty()) {
      findings.add(path + ".name", path + ".name is missing, expected a name for this " + key);
    } else if (!is_one_line(name) || name.front() == ' ' || name.back() == ' ') {
      findings.add(path + ".name",
                   path + ".name has control characters or outer spaces, expected a plain name");
    } else if (is_formula(name)) {
      findings.add(path + ".name", path + ".name = \"" + name + "\": " + kFormulaName);
    } else {
      const auto [first, is_new] = seen.try_emplace(name, i);
      if (!is_new)
        findings.add(path + ".name", path + ".name \"" + name + "\" is also the name of " + key +
                                         "[" + std::to_string(first->second) +
                                         "], expected a name of its own");
    }
    names.push_back(name);
  }
  return names;
}

}  // namespace irsig
