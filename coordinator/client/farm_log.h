#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "spdlog/common.h"

namespace irsig {

// The log of coordinators and workers, on standard error: a line for each event, with its time,
// level and subject, so that the logs of all machines can be joined by job. Lines quote text of
// other machines without its control characters, so that no text can forge a second line or write
// to the terminal that shows it.

struct LogOptions {
  std::string format = "text";  // or "json": an object a line; time in UTC
  std::string level = "info";   // lowest level logged; debug: every lease and result
};
// Adds the options of a program that logs. App: CLI::App.
template <class App>
void add_log_options(App& app, LogOptions& options) {
  app.add_option("--log-format", options.format,
                 "of the lines on standard error: text, or json, an object a line")
      ->capture_default_str();
  app.add_option(
         "--log-level", options.level,
         "the least that is said: debug (every lease and result), info, warning, error or off")
      ->capture_default_str();
}
// Starts the log. Earlier lines are text without a program. INVALID_ARGUMENT: an unknown name.
[[nodiscard]] absl::Status start_log(const std::string& program, const LogOptions& options);

// Subject of a line; empty members are left out. [text: the first 12 digits of a key]
struct LogAbout {
  std::string_view job_key = {};  // or its first digits
  std::string_view worker = {};
  std::string_view sweep = {};  // its name
};
using LogLevel = spdlog::level::level_enum;  // debug, info, warn, err
void log_line(LogLevel level, const LogAbout& about, std::string_view text);
[[nodiscard]] bool is_logged(LogLevel level);

template <class... Arguments>
void log_line(LogLevel level, const LogAbout& about, fmt::format_string<Arguments...> text,
              Arguments&&... arguments) requires(sizeof...(Arguments) > 0) {
  if (!is_logged(level)) return;
  log_line(level, about,
           std::string_view(fmt::format(text, std::forward<Arguments>(arguments)...)));
}

}  // namespace irsig
