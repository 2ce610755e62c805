#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace irsig {

// Returns the known name that is close to an unknown one. nullopt: none is close.
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view unknown,
                                                      const std::vector<std::string>& known);

// Returns the end of an error message about an unknown name: `did you mean "funnel"?` if a known
// name is close, else `expected one of "deck", "hull"`.
[[nodiscard]] std::string suggestion(std::string_view unknown,
                                     const std::vector<std::string>& known);

// Returns the names as a list: "a", "b", "c".
[[nodiscard]] std::string quoted_list(const std::vector<std::string>& names);

}  // namespace irsig
