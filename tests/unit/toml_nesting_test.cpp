#include "jobs/text/toml_nesting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "jobs/text/sweep_file.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string repeated(int count, const std::string& piece) {
  std::string text;
  for (int i = 0; i < count; ++i) text += piece;
  return text;
}

std::string refusal(const std::string& text) {
  return std::string(check_toml_nesting(text, "a.toml").message());
}

TEST(TomlNesting, KeysOf32PartsAnd32Brackets) {
  EXPECT_EQ(refusal(repeated(31, "a.") + "a = 1.5"), "");
  EXPECT_EQ(refusal(repeated(32, "a.") + "a = 1"),
            "a.toml:1:64: a key of more than 32 parts, expected the keys of a sweep file");
  EXPECT_EQ(refusal("x = " + repeated(32, "[") + repeated(32, "]")), "");
  EXPECT_THAT(refusal("\n# é\nx = " + repeated(33, "[")), StartsWith("a.toml:3:37: more than 32"));
  // Columns are characters; parts may stand in quotes, with blanks around the dots.
  EXPECT_THAT(refusal("\n" + repeated(32, "'é' . ") + "a = 1"), StartsWith("a.toml:2:191: a key"));
  // Levels of brackets and keys together stay few enough to be taken down.
  const std::string deepest =
      "x = " + repeated(32, "{" + repeated(31, "a.") + "a = ") + "1" + repeated(32, "}");
  EXPECT_EQ(refusal(deepest), "");
  EXPECT_THAT(std::string(parse_sweep(deepest, "a.toml").status().message()),
              HasSubstr("unknown key \"x\""));
}

TEST(TomlNesting, StringsCommentsAndValuesAreNoKeys) {
  const std::string many = repeated(100, ".") + repeated(100, "[{");
  for (const std::string& text :
       {"a = \"" + many + "\"", "a = '" + many + "'", "# " + many, "a = \"\\\"" + many + "\"",
        "a = 'b\\' # " + many,
        "a = \"\"\"\n" + many + "\"" + many + "\\\"\"\"" + many + "\"\"\"\"\"",
        "a = '''\n" + many + "''" + many + "'''", "a = \"\" # " + many, "a = '' # " + many,
        "a = [" + repeated(100, "1.5, ") + "]", repeated(100, "a.b = 1.5\n"),
        repeated(100, "[[part]]\n"), "a = [" + repeated(100, "{b.c = 1.5},\n") + "]"})
    EXPECT_EQ(refusal(text), "") << text;
  // The text after a string is looked at again.
  for (const std::string string : {"\"\"", "''", "\"\"\"\"\"\"", "''''''", "\"\"\"a\"\"\"\"\"",
                                   "'''a'''''", "\"\\\\\"", "'\\'", "\"\"\"\\\"\"\"\""})
    EXPECT_THAT(refusal("a = " + string + "\n" + repeated(100, "b.") + "b = 1"),
                StartsWith("a.toml:2:64: a key of more than 32 parts"))
        << string;
}

}  // namespace
}  // namespace irsig
