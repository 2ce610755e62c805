#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace irsig {

// Names of which a filter admits each; an empty set admits every name. An empty string stands for
// the empty set, so that a filter of one name or of none is written as a string.
class NameSet {
 public:
  NameSet() = default;
  NameSet(std::string name) {  // NOLINT(google-explicit-constructor): see above
    if (!name.empty()) names_.push_back(std::move(name));
  }
  NameSet(const char* name) : NameSet(std::string(name)) {}  // NOLINT(google-explicit-constructor)
  explicit NameSet(std::vector<std::string> names) : names_(std::move(names)) {}

  [[nodiscard]] bool empty() const { return names_.empty(); }
  // Returns the names in the order in which they were given.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  // Returns whether the filter admits a name.
  [[nodiscard]] bool admits(const std::string& name) const {
    return names_.empty() || std::find(names_.begin(), names_.end(), name) != names_.end();
  }
  // Returns the names as an array in JSON, which SQL reads with json_each(); empty: every name.
  [[nodiscard]] std::string json() const;

 private:
  std::vector<std::string> names_;
};

}  // namespace irsig
