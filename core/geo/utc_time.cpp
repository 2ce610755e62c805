#include <erfa.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/geo/sun.h"

namespace irsig {
namespace {

// Reads an RFC 3339 time from left to right; every reader leaves the text as it was when it does
// not match.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  // Exactly `count` decimal digits.
  std::optional<int> digits(std::size_t count) {
    if (text_.size() < count) return std::nullopt;
    int value = 0;
    for (const char c : text_.substr(0, count)) {
      if (c < '0' || c > '9') return std::nullopt;
      value = 10 * value + (c - '0');
    }
    text_.remove_prefix(count);
    return value;
  }

  // Returns the next character if it is one of these; 0 if not.
  char any_of(std::string_view characters) {
    if (text_.empty() || characters.find(text_.front()) == std::string_view::npos) return 0;
    const char c = text_.front();
    text_.remove_prefix(1);
    return c;
  }

  // "dd", or "dd.ddd..."
  std::optional<double> seconds() {
    std::size_t length = 2;
    if (text_.size() > 2 && text_[2] == '.') {
      length = 3;
      while (length < text_.size() && text_[length] >= '0' && text_[length] <= '9') ++length;
      if (length == 3) return std::nullopt;
    }
    if (text_.size() < length || text_[0] < '0' || text_[0] > '9') return std::nullopt;
    double value = 0.0;
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + length, value);
    if (error != std::errc() || end != text_.data() + length) return std::nullopt;
    text_.remove_prefix(length);
    return value;
  }

  [[nodiscard]] bool at_end() const { return text_.empty(); }

 private:
  std::string_view text_;
};

absl::Status refuse(std::string_view text, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat("time \"", std::string(text), "\": ", why));
}

int days_in_month(int year, int month) {
  constexpr std::array<int, 12> kDays = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return kDays[static_cast<std::size_t>(month - 1)] + (month == 2 && leap ? 1 : 0);
}

void shift_day(UtcTime& time, int by) {
  time.day += by;
  if (time.day < 1) {
    if (--time.month < 1) {
      time.month = 12;
      --time.year;
    }
    time.day = days_in_month(time.year, time.month);
  } else if (time.day > days_in_month(time.year, time.month)) {
    time.day = 1;
    if (++time.month > 12) {
      time.month = 1;
      ++time.year;
    }
  }
}

// Returns true if ERFA's table has a leap second at the end of this day. For times of 23:59:60 and
// later.
bool is_leap_second(const UtcTime& utc) {
  double date1 = 0.0;
  double date2 = 0.0;
  const int status = eraDtf2d("UTC", utc.year, utc.month, utc.day, utc.hour, utc.minute, utc.second,
                              &date1, &date2);
  constexpr int kAfterEndOfDay = 2;  // added to 1 for a year that is outside the table
  return status >= 0 && (status & kAfterEndOfDay) == 0;
}

constexpr const char* kExpected =
    "expected RFC 3339 with offset, like 2025-12-21T10:30:00+09:00 or 2025-12-21T01:30:00Z";

}  // namespace

absl::StatusOr<UtcTime> parse_rfc3339(std::string_view text) {
  Reader in(text);
  const auto year = in.digits(4);
  if (!year || !in.any_of("-")) return refuse(text, kExpected);
  const auto month = in.digits(2);
  if (!month || !in.any_of("-")) return refuse(text, kExpected);
  const auto day = in.digits(2);
  if (!day || !in.any_of("Tt ")) return refuse(text, kExpected);
  const auto hour = in.digits(2);
  if (!hour || !in.any_of(":")) return refuse(text, kExpected);
  const auto minute = in.digits(2);
  if (!minute) return refuse(text, kExpected);
  // ISO 8601 allows a time without seconds.
  const auto second = in.any_of(":") ? in.seconds() : std::optional<double>(0);
  if (!second) return refuse(text, kExpected);
  if (in.at_end()) return refuse(text, absl::StrCat("it has no offset; ", kExpected));

  int offset_minutes = 0;
  if (!in.any_of("Zz")) {
    const char sign = in.any_of("+-");
    if (sign == 0) return refuse(text, kExpected);
    const auto offset_hour = in.digits(2);
    if (!offset_hour || !in.any_of(":")) return refuse(text, kExpected);
    const auto offset_minute = in.digits(2);
    if (!offset_minute) return refuse(text, kExpected);
    if (*offset_hour > 23 || *offset_minute > 59) {
      return refuse(text, "its offset must be between -23:59 and +23:59");
    }
    offset_minutes = (sign == '-' ? -1 : 1) * (60 * *offset_hour + *offset_minute);
  }
  if (!in.at_end()) return refuse(text, kExpected);

  if (*month < 1 || *month > 12) return refuse(text, "its month must be between 01 and 12");
  if (*day < 1 || *day > days_in_month(*year, *month)) {
    return refuse(text,
                  absl::StrCat("its day must be between 01 and ", days_in_month(*year, *month)));
  }
  if (*hour > 23) return refuse(text, "its hour must be between 00 and 23");
  if (*minute > 59) return refuse(text, "its minute must be between 00 and 59");
  if (!(*second < 61.0)) return refuse(text, "its second must be below 60, or 61 in a leap second");

  UtcTime utc{*year, *month, *day, 0, 0, *second};
  int minute_of_day = 60 * *hour + *minute - offset_minutes;
  constexpr int kDayMinutes = 24 * 60;
  if (minute_of_day < 0) {
    shift_day(utc, -1);
    minute_of_day += kDayMinutes;
  } else if (minute_of_day >= kDayMinutes) {
    shift_day(utc, +1);
    minute_of_day -= kDayMinutes;
  }
  utc.hour = minute_of_day / 60;
  utc.minute = minute_of_day % 60;
  if (utc.year < 0 || utc.year > 9999) return refuse(text, "its year in UTC is not 0000 to 9999");
  if (utc.second >= 60.0 && !(utc.hour == 23 && utc.minute == 59 && is_leap_second(utc))) {
    return refuse(text, "UTC had no leap second then");
  }
  return utc;
}

std::string format_rfc3339_utc(const UtcTime& time) {
  std::array<char, 48> date{};
  std::snprintf(date.data(), date.size(), "%04d-%02d-%02dT%02d:%02d:", time.year, time.month,
                time.day, time.hour, time.minute);
  // The shortest text that reads back as the same double: rounding 59.9999999999 to 60 would name
  // another second.
  std::array<char, 400> second{};
  const auto end = std::to_chars(second.data(), second.data() + second.size(), time.second,
                                 std::chars_format::fixed);
  const std::string seconds(second.data(), end.ptr);
  return absl::StrCat(date.data(), time.second < 10.0 ? "0" : "", seconds, "Z");
}

double unix_seconds(const UtcTime& time) {
  const std::chrono::year_month_day day{std::chrono::year(time.year),
                                        std::chrono::month(static_cast<unsigned>(time.month)),
                                        std::chrono::day(static_cast<unsigned>(time.day))};
  const auto days = std::chrono::sys_days(day).time_since_epoch().count();
  return 86400.0 * static_cast<double>(days) + 3600.0 * time.hour + 60.0 * time.minute +
         time.second;
}

UtcTime utc_time(double unix_s) {
  const double day = std::floor(unix_s / 86400);
  const std::chrono::year_month_day date{
      std::chrono::sys_days(std::chrono::days(static_cast<int>(day)))};
  const double of_day = unix_s - 86400 * day;
  const int minute = std::min(1439, static_cast<int>(of_day / 60));
  return {static_cast<int>(date.year()),
          static_cast<int>(static_cast<unsigned>(date.month())),
          static_cast<int>(static_cast<unsigned>(date.day())),
          minute / 60,
          minute % 60,
          of_day - 60 * minute};
}

}  // namespace irsig
