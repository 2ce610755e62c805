#include "core/base/formula.h"

#include "absl/strings/numbers.h"
#include "absl/strings/string_view.h"

namespace irsig {

bool is_formula(std::string_view text) {
  constexpr std::string_view kBegin = "=+-@\t\r";
  if (text.empty() || kBegin.find(text.front()) == std::string_view::npos) return false;
  double number = 0;
  return !absl::SimpleAtod(absl::string_view(text.data(), text.size()), &number);
}

}  // namespace irsig
