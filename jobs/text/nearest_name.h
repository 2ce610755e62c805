#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace irsig {

// The known name that is close to an unknown one, if any is.
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view unknown,
                                                      const std::vector<std::string>& known);

// The end of an error about a name that nobody knows: `did you mean "funnel"?` when one of the
// known names is close to it, else `expected one of "deck", "hull"`.
[[nodiscard]] std::string suggestion(std::string_view unknown,
                                     const std::vector<std::string>& known);

// "a", "b", "c"
[[nodiscard]] std::string quoted_list(const std::vector<std::string>& names);

}  // namespace irsig
