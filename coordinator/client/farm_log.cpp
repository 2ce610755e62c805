#include "coordinator/client/farm_log.h"

#include <algorithm>
#include <iterator>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/printable.h"
#include "spdlog/pattern_formatter.h"
#include "spdlog/sinks/stdout_sinks.h"
#include "spdlog/spdlog.h"

namespace irsig {
namespace {

constexpr const char* kLevels[] = {"debug", "info", "warning", "error", "off"};

// Context of the line that this thread is writing. Loggers write at once, in the calling thread.
thread_local const LogAbout* about_now = nullptr;

std::string line_of(const LogAbout& about, std::string_view text) {
  std::string out;
  const auto add = [&](std::string_view what, std::string_view name) {
    if (!name.empty()) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", what, name);
  };
  add("sweep", about.sweep);
  add("job", about.job_key.substr(0, 12));
  add("worker", about.worker);
  return one_line(out.empty() ? std::string(text) : fmt::format("{}: {}", out, text));
}

std::string json_of(const LogAbout& about, std::string_view text) {
  std::string out;
  for (const auto& [name, value] :
       {std::pair<std::string_view, std::string_view>{"sweep", about.sweep},
        {"job_key", about.job_key},
        {"worker", about.worker},
        {"message", text}}) {
    if (!value.empty()) out += fmt::format(", \"{}\": {}", name, json_string(value));
  }
  return out;
}

class FarmLog final : public spdlog::formatter {
 public:
  explicit FarmLog(bool json)
      : json_(json),
        pattern_(json
                     ? std::make_unique<spdlog::pattern_formatter>(
                           R"({"time": "%Y-%m-%dT%H:%M:%S.%eZ", "program": "%n", "level": "%l"%v})",
                           spdlog::pattern_time_type::utc)
                     : std::make_unique<spdlog::pattern_formatter>()) {}
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    const std::string_view said(message.payload.data(), message.payload.size());
    const LogAbout about = about_now ? *about_now : LogAbout();
    const std::string text = json_ ? json_of(about, said) : line_of(about, said);
    spdlog::details::log_msg plain = message;
    plain.payload = text;
    pattern_->format(plain, line);
  }
  [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<FarmLog>(json_);
  }

 private:
  bool json_;
  std::unique_ptr<spdlog::pattern_formatter> pattern_;
};

}  // namespace

absl::Status start_log(const std::string& program, const LogOptions& options) {
  if (options.format != "text" && options.format != "json")
    return absl::InvalidArgumentError(
        absl::StrCat("--log-format: \"", options.format, "\", expected text or json"));
  const auto level = std::find(std::begin(kLevels), std::end(kLevels), options.level);
  if (level == std::end(kLevels))
    return absl::InvalidArgumentError(absl::StrCat("--log-level: \"", options.level,
                                                   "\", expected ", absl::StrJoin(kLevels, ", ")));
  spdlog::set_default_logger(spdlog::stderr_logger_mt(program));
  spdlog::set_formatter(std::make_unique<FarmLog>(options.format == "json"));
  spdlog::set_level(spdlog::level::from_str(options.level));
  return absl::OkStatus();
}

bool is_logged(LogLevel level) { return spdlog::should_log(level); }

void log_line(LogLevel level, const LogAbout& about, std::string_view text) {
  about_now = &about;
  spdlog::log(level, text);
  about_now = nullptr;
}

}  // namespace irsig
