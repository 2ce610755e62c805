// The sweep parser against damaged files: deterministic mutations of every example and bad sweep, a
// bounded number of them, and against files that are deep and long.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "jobs/text/sweep_file.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/turns.h"

namespace irsig {
namespace {

constexpr std::size_t kExamples = 9;  // the first of the corpus

using Random = std::mt19937;  // the standard fixes its sequence: the same mutations everywhere

std::size_t below(Random& random, std::size_t bound) { return bound == 0 ? 0 : random() % bound; }

std::string mutated(const std::vector<std::string>& texts, Random& random) {
  static const std::vector<std::string> values = {"nan",
                                                  "-inf",
                                                  "1e999",
                                                  "-0",
                                                  "0",
                                                  "1",
                                                  "0.5",
                                                  "42",
                                                  "300",
                                                  "-1",
                                                  "99999999999999999999",
                                                  "1e308",
                                                  "4294967295",
                                                  "true",
                                                  "[]",
                                                  "{}",
                                                  "\"\"",
                                                  "\"\\u0000\"",
                                                  "2025-12-21",
                                                  "2025-13-41",
                                                  "24:00:00"};
  static const std::vector<std::string> tokens = {"[",
                                                  "]",
                                                  "{",
                                                  "}",
                                                  "[[",
                                                  "]]",
                                                  "=",
                                                  ".",
                                                  "\n",
                                                  "#",
                                                  "\"\"\"",
                                                  "'",
                                                  "\xff",
                                                  "\xef\xbb\xbf",
                                                  "[[part]]\n",
                                                  "a.b.c.d = 1\n",
                                                  "[model]\n",
                                                  "part = 3\n",
                                                  "time = []\n",
                                                  "[season.surroundings]\n",
                                                  "[viewpoints]\n"};
  // Every other mutation starts from an example, which is right before it is damaged.
  std::string text = texts[below(random, random() % 2 == 0 ? kExamples : texts.size())];
  const std::size_t edits = 1 + below(random, 4);
  for (std::size_t e = 0; e < edits; ++e) {
    const std::size_t at = below(random, text.size() + 1), length = below(random, 40);
    switch (random() % 12) {  // half of the edits keep the syntax and change a value
      case 0:                 // one byte
        if (at < text.size()) text[at] = static_cast<char>(random() % 256);
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, tokens[below(random, tokens.size())]);
        break;
      case 3:  // a piece twice
        text.insert(at, text.substr(below(random, text.size()), length));
        break;
      case 4:
        text.resize(at);
        break;
      case 5: {  // a piece of another file
        const std::string& other = texts[below(random, texts.size())];
        text.insert(at, other.substr(below(random, other.size()), 10 * length));
        break;
      }
      default: {  // a value becomes another
        const std::size_t equals = text.find("= ", at);
        if (equals == std::string::npos) break;
        const std::size_t end = std::min(text.find('\n', equals), text.size());
        text.replace(equals + 2, end - equals - 2, values[below(random, values.size())]);
      }
    }
  }
  return text;
}

TEST(SweepFileFuzz, EveryMutationIsReadOrRefusedWithAPlace) {
  const fuzz::Reader& reader = *fuzz::reader_named("sweep");
  ASSERT_GT(reader.sound.size(), 40U);
  Random random(20251221);
  int accepted = 0;
  for (fuzz::Turns turn(20000); turn.next();) {
    const std::string text = mutated(reader.sound, random);
    accepted += reader.accepts(text) ? 1 : 0;
    ASSERT_FALSE(HasFailure()) << text;
  }
  // Mutations that are all refused at the first byte would test nothing.
  EXPECT_GT(accepted, 200);
}

TEST(SweepFileFuzz, DeepAndLongFilesEnd) {
  const auto repeated = [](int count, const std::string& piece) {
    std::string text;
    for (int i = 0; i < count; ++i) text += piece;
    return text;
  };
  // The parser alone overflows the stack on these keys.
  for (const std::string& text :
       {repeated(100000, "a.") + "a = 1", repeated(100000, "a . ") + "a = 1",
        "[" + repeated(100000, "a.") + "a]", "[[" + repeated(100000, "\"a\".") + "a]]",
        "x = {" + repeated(100000, "a.") + "a = 1}", "x = " + repeated(100000, "{ a = "),
        "x = " + repeated(100000, "[") + repeated(100000, "]"),
        "x = \"\"\"\"\"\"\n" + repeated(100000, "'a'.") + "a = 1",
        "x = '''a'''''\n" + repeated(100000, "a.") + "a = 1"}) {
    const absl::StatusOr<SweepFile> file = parse_sweep(text, "fuzz.toml");
    ASSERT_FALSE(file.ok());
    fuzz::refused(file.status(), "fuzz.toml");
  }
  for (const std::string& piece : {std::string("["), std::string("{a="), std::string("a."),
                                   std::string("[[a]]\n"), std::string("\"")}) {
    std::string text = "name = ";
    for (int i = 0; i < 20000; ++i) text += piece;
    const absl::StatusOr<SweepFile> file = parse_sweep(text, "fuzz.toml");
    ASSERT_FALSE(file.ok());
    fuzz::refused(file.status(), "fuzz.toml");
  }
}

}  // namespace
}  // namespace irsig
