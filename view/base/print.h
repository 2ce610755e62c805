#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <ostream>
#include <string_view>

namespace irsig {

// The doors to the terminal. Names, messages and warnings come from databases, files and other
// machines: none of them may move a cursor or write a window's title (core/base/printable.h).

void print_plain(std::FILE* to, std::string_view text);

// Print for people, to standard output and to standard error.
template <typename... Args>
void print_text(fmt::format_string<Args...> format, Args&&... args) {
  print_plain(stdout, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void print_note(fmt::format_string<Args...> format, Args&&... args) {
  print_plain(stderr, fmt::format(format, std::forward<Args>(args)...));
}

// The stream for tables: unchanged bytes for programs, without control characters where standard
// output is a terminal.
[[nodiscard]] std::ostream& data_output();

}  // namespace irsig
