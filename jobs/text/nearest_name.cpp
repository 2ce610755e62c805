#include "jobs/text/nearest_name.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace irsig {
namespace {

// Levenshtein distance with a swap of neighbours counted as one edit ("sesaon").
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  std::iota(above.begin(), above.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before = above;
    above = row;
  }
  return above[b.size()];
}

}  // namespace

std::string quoted_list(const std::vector<std::string>& names) {
  return absl::StrJoin(names, ", ", [](std::string* out, const std::string& name) {
    absl::StrAppend(out, "\"", name, "\"");
  });
}

std::optional<std::string> nearest_name(std::string_view unknown,
                                        const std::vector<std::string>& known) {
  // Names far longer than any known one are not worth the quadratic comparison.
  constexpr std::size_t kLongest = 100;
  const std::string* nearest = nullptr;
  std::size_t nearest_distance = 0;
  if (unknown.size() <= kLongest) {
    const std::string lower = absl::AsciiStrToLower(std::string(unknown));
    for (const std::string& name : known) {
      if (name.size() > kLongest) continue;
      // Another case is one edit at most, so that "QUERY" is near to "query".
      const std::size_t distance =
          std::min(edit_distance(unknown, name),
                   edit_distance(lower, absl::AsciiStrToLower(name)) + (lower == unknown ? 0 : 1));
      if (nearest == nullptr || distance < nearest_distance) {
        nearest = &name;
        nearest_distance = distance;
      }
    }
  }
  if (nearest != nullptr && nearest_distance < unknown.size() &&
      nearest_distance <= std::max<std::size_t>(1, unknown.size() / 3))
    return *nearest;
  return std::nullopt;
}

std::string suggestion(std::string_view unknown, const std::vector<std::string>& known) {
  if (const auto near = nearest_name(unknown, known))
    return absl::StrCat("did you mean \"", *near, "\"?");
  if (known.empty()) return "there are none";
  return absl::StrCat("expected one of ", quoted_list(known));
}

}  // namespace irsig
