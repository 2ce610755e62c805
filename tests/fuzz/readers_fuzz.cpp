// Every reader of files that somebody else wrote against mutants of sound files, the same ones in
// every run, and against the files that a search guided by its branches once found
// (ops/fuzz.sh): each is refused in words that say where, or what is read is sound. Run it with
// IRSIG_SANITIZE=address,undefined to see more.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/fuzz/corpus.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/turns.h"

namespace irsig::fuzz {
namespace {

class Readers : public testing::TestWithParam<std::string> {};

TEST_P(Readers, RefuseMutantsOrReadWhatIsSound) {
  const Reader& reader = *reader_named(GetParam());
  Mutator mutator(static_cast<std::uint64_t>(&reader - readers().data()), reader.words,
                  reader.crowded);
  int accepted = 0, tried = 0;
  for (Turns turn(reader.turns); turn.next(); ++tried) {
    const std::string text =
        mutator.mutate(reader.sound[static_cast<std::size_t>(turn.index()) % reader.sound.size()]);
    accepted += reader.accepts(text) ? 1 : 0;
    ASSERT_FALSE(HasFailure()) << text;
  }
  // Mutants that are all refused at their first word would test nothing.
  EXPECT_GT(accepted, tried / 400);
  EXPECT_LT(accepted, tried);
}

TEST_P(Readers, RefuseWhatWasFoundOrReadWhatIsSound) {
  const Reader& reader = *reader_named(GetParam());
  const std::vector<std::string> found = read_corpus(reader.name);
  EXPECT_GT(found.size(), 10U);
  for (const std::string& text : found) {
    reader.accepts(text);
    ASSERT_FALSE(HasFailure()) << text;
  }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Readers, testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const Reader& reader : readers()) names.push_back(reader.name);
                           return names;
                         }()),
                         [](const auto& reader) { return reader.param; });

}  // namespace
}  // namespace irsig::fuzz
