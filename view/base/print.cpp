#include "view/base/print.h"

#include <unistd.h>

#include <iostream>
#include <streambuf>
#include <string>

#include "core/base/printable.h"

namespace irsig {
namespace {

// Hands on whole lines, so that no character is cut in two.
class TerminalBuffer final : public std::streambuf {
 public:
  ~TerminalBuffer() override { hand_on(); }
  TerminalBuffer() = default;
  TerminalBuffer(const TerminalBuffer&) = delete;
  TerminalBuffer& operator=(const TerminalBuffer&) = delete;

 protected:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    line_ += traits_type::to_char_type(c);
    return traits_type::to_char_type(c) != '\n' || hand_on() ? c : traits_type::eof();
  }
  int sync() override { return hand_on() ? 0 : -1; }

 private:
  bool hand_on() {
    std::cout << printable(line_) << std::flush;
    line_.clear();
    return static_cast<bool>(std::cout);
  }
  std::string line_;
};

}  // namespace

void print_plain(std::FILE* to, std::string_view text) {
  const std::string plain = printable(text);
  std::fwrite(plain.data(), 1, plain.size(), to);
}

std::ostream& data_output() {
  if (isatty(STDOUT_FILENO) == 0) return std::cout;
  static TerminalBuffer buffer;
  static std::ostream terminal(&buffer);
  return terminal;
}

}  // namespace irsig
