#include "tests/fuzz/corpus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace irsig::fuzz {
namespace {
std::string path_of(const std::string& name) {
  return std::string(IRSIG_SOURCE_DIR "/tests/fuzz/corpus/") + name;
}
}  // namespace

std::vector<std::string> read_corpus(const std::string& name) {
  std::ifstream in(path_of(name), std::ios::binary);
  EXPECT_TRUE(in.is_open()) << path_of(name);
  std::vector<std::string> out;
  std::size_t size = 0;
  while (in >> size) {
    in.get();
    std::string text(size, '\0');
    in.read(text.data(), static_cast<std::streamsize>(size));
    EXPECT_EQ(in.get(), '\n') << path_of(name);
    out.push_back(std::move(text));
  }
  EXPECT_TRUE(in.eof()) << path_of(name);
  return out;
}

void write_corpus(const std::string& name, std::vector<std::string> inputs) {
  std::sort(inputs.begin(), inputs.end());
  std::ofstream out(path_of(name), std::ios::binary | std::ios::trunc);
  for (const std::string& text : inputs) out << text.size() << "\n" << text << "\n";
}

}  // namespace irsig::fuzz
