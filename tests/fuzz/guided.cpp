// A search for files that break a reader, guided by its branches (LLVM's libFuzzer): ops/fuzz.sh.
//
//   IRSIG_FUZZ_READER=NAME fuzz_guided FOLDER ...   of libFuzzer: inputs that reach new branches go
//                                                   into the first folder
//   fuzz_guided --readers                           their names
//   fuzz_guided --unpack NAME FOLDER                sound files and the kept corpus, one file each
//   fuzz_guided --pack NAME FOLDER                  the other way round
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "tests/fuzz/corpus.h"
#include "tests/fuzz/readers.h"

namespace irsig::fuzz {
namespace {

namespace fs = std::filesystem;
// Most bytes of all inputs together: a corpus is replayed in every run of the suite, and kept.
constexpr std::size_t kMostBytes = 150'000;
const Reader* chosen = nullptr;

int fail(const std::string& what) {
  std::fprintf(stderr, "fuzz_guided: %s\n", what.c_str());
  std::exit(2);
}

void unpack(const Reader& reader, const std::string& folder) {
  std::size_t count = 0;
  const auto put = [&](const std::string& text) {
    std::ofstream(folder + "/" + std::to_string(count++), std::ios::binary) << text;
  };
  for (const std::string& text : reader.sound) put(text);
  if (fs::exists(std::string(IRSIG_SOURCE_DIR "/tests/fuzz/corpus/") + reader.name))
    for (const std::string& text : read_corpus(reader.name)) put(text);
}

// The shortest ones, if they are too many.
void pack(const Reader& reader, const std::string& folder) {
  std::vector<std::string> inputs;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  std::sort(inputs.begin(), inputs.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  std::size_t bytes = 0, count = 0;
  while (count < inputs.size() && (bytes += inputs[count].size()) <= kMostBytes) ++count;
  std::printf("%s: %zu of %zu inputs are kept\n", reader.name.c_str(), count, inputs.size());
  inputs.resize(count);
  write_corpus(reader.name, std::move(inputs));
}

}  // namespace
}  // namespace irsig::fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace irsig::fuzz;
  const auto argument = [&](int i) { return std::string(i < *argc ? (*argv)[i] : ""); };
  testing::InitGoogleTest();
  if (argument(1) == "--readers") {
    for (const Reader& reader : readers()) std::puts(reader.name.c_str());
    std::exit(0);
  }
  const bool packs = argument(1) == "--pack", unpacks = argument(1) == "--unpack";
  const char* const asked = std::getenv("IRSIG_FUZZ_READER");
  const std::string name = packs || unpacks ? argument(2) : asked != nullptr ? asked : "";
  chosen = reader_named(name);
  if (chosen == nullptr) fail("no reader \"" + name + "\": --readers lists them");
  if (packs) pack(*chosen, argument(3));
  if (unpacks) unpack(*chosen, argument(3));
  if (packs || unpacks) std::exit(0);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  irsig::fuzz::chosen->accepts({reinterpret_cast<const char*>(data), size});
  // An expectation that was broken ends the program, as the search asks for.
  if (testing::UnitTest::GetInstance()->ad_hoc_test_result().Failed()) std::abort();
  return 0;
}
