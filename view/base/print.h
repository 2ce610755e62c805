#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <ostream>
#include <string_view>

namespace irsig {

// Functions that print to the terminal. Names, messages and warnings come from databases, files and
// other machines; none of them may move the cursor or change a window's title
// (core/base/printable.h).

void print_plain(std::FILE* to, std::string_view text);

// Prints text for people: print_text() to standard output, print_note() to standard error.
template <typename... Args>
void print_text(fmt::format_string<Args...> format, Args&&... args) {
  print_plain(stdout, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void print_note(fmt::format_string<Args...> format, Args&&... args) {
  print_plain(stderr, fmt::format(format, std::forward<Args>(args)...));
}

// Returns the stream for tables. Programs receive unchanged bytes; a terminal receives them without
// control characters.
[[nodiscard]] std::ostream& data_output();

}  // namespace irsig
