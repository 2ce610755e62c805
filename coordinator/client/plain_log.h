#pragma once

#include <memory>

#include "core/base/printable.h"
#include "spdlog/pattern_formatter.h"
#include "spdlog/spdlog.h"

namespace irsig {

// Log lines quote what other machines say. One message is one line, without control characters: it
// can neither forge a second line nor write to the terminal that shows the log.
class PlainLog final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    const std::string text = one_line({message.payload.data(), message.payload.size()});
    spdlog::details::log_msg plain = message;
    plain.payload = text;
    pattern_.format(plain, line);
  }
  [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<PlainLog>();
  }

 private:
  spdlog::pattern_formatter pattern_;
};

}  // namespace irsig
