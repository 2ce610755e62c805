#include "jobs/text/time_of_day.h"

#include <cctype>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"

namespace irsig {

TimeOfDay time_of_day(const std::string& text) {
  constexpr const char* kExample =
      "expected a time of day with its offset from UTC: \"10:30+09:00\" or \"01:30Z\"";
  const auto digit_at = [&](std::size_t i) {
    return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0;
  };
  if (!(digit_at(0) && digit_at(1) && text.size() > 4 && text[2] == ':' && digit_at(3) &&
        digit_at(4))) {
    return {"", absl::StrCat("is no time of day, ", kExample)};
  }
  std::size_t offset = 5;
  while (offset < text.size() && (digit_at(offset) || text[offset] == ':' || text[offset] == '.'))
    ++offset;
  if (offset == text.size()) return {"", absl::StrCat("has no offset, ", kExample)};
  const std::string seconds = text.substr(5, offset - 5);
  return {absl::StrCat(text.substr(0, 5), seconds.empty() ? ":00" : seconds, text.substr(offset)),
          ""};
}

absl::StatusOr<DayTime> day_time(const std::string& text) {
  constexpr double kDayS = 86400;
  // A day without leap second, far from the ends of the calendar.
  constexpr const char* kAnyDay = "2001-01-01T";
  ASSIGN_OR_RETURN(const auto utc, parse_rfc3339(absl::StrCat(kAnyDay, text)));
  ASSIGN_OR_RETURN(
      const auto local,
      parse_rfc3339(absl::StrCat(kAnyDay, text.substr(0, text.find_first_of("+-Zz")), "Z")));
  const auto of_day = [](double unix_s) { return unix_s - std::floor(unix_s / kDayS) * kDayS; };
  const double utc_s = unix_seconds(utc), local_s = unix_seconds(local);
  return DayTime{of_day(local_s), of_day(utc_s), local_s - utc_s};
}

}  // namespace irsig
