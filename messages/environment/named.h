#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "core/base/problems.h"

namespace irsig {

// Returns the value that a message's name stands for. An unknown name is an error, never the last
// of the values: "KEY: there is no "given"; expected one of ...".
template <typename Value>
[[nodiscard]] absl::StatusOr<Value> named(
    std::string_view key, std::string_view given,
    std::initializer_list<std::pair<std::string_view, Value>> known) {
  std::string names;
  for (const auto& [name, value] : known) {
    if (name == given) return value;
    names.append(names.empty() ? "" : ", ").append(name);
  }
  return keyed_problem(std::string(key),
                       absl::StrCat("there is no \"", std::string(given), "\"; expected one of ", names));
}

}  // namespace irsig
