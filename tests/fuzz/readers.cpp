#include "tests/fuzz/readers.h"

#include <gtest/gtest.h>

#include <iterator>
#include <regex>
#include <sstream>
#include <utility>

namespace irsig::fuzz {

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all = [] {
    std::vector<Reader> out;
    for (const auto& some : {air_readers(), optical_readers(), table_readers(), scene_readers()})
      out.insert(out.end(), some.begin(), some.end());
    return out;
  }();
  return all;
}

const Reader* reader_named(std::string_view name) {
  for (const Reader& reader : readers())
    if (reader.name == name) return &reader;
  return nullptr;
}

bool refused(const absl::Status& status, std::string_view file, Says says) {
  static const std::regex placed("^[^\n]*:[1-9][0-9]*:[1-9][0-9]*: .");
  static const std::regex more(": (and [0-9]+ more errors?|too many errors, reading stopped)$");
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  const std::string message(status.message());
  EXPECT_TRUE(message.starts_with(file)) << message;
  EXPECT_GT(message.size(), file.size() + 2) << message;
  if (says == Says::kFile) return false;
  std::stringstream lines(message);
  std::string line;
  int count = 0;
  for (; std::getline(lines, line); ++count)
    EXPECT_TRUE(std::regex_search(line, placed) || (count > 0 && std::regex_search(line, more)))
        << line;
  EXPECT_GT(count, 0);
  return false;
}

}  // namespace irsig::fuzz
