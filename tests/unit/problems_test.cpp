// The problems of a status: nobody searches its message for a place or a key.
#include "core/base/problems.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/formula.h"

namespace irsig {
namespace {

TEST(Problems, ComeBackAsTheyWereWhateverTheirTextsHold) {
  const std::vector<Problem> given = {
      {"a.toml:3:1", "part[0].name", "part[0].name: two\nlines: 5:x"},
      {"", "", ""},
      {std::string("\0:9:1", 5), "12:3:", "x.toml:1:1: no place of its own"}};
  const absl::Status status = problem_status(given);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  const std::vector<Problem> back = problems_of(status);
  ASSERT_EQ(back.size(), given.size());
  for (std::size_t i = 0; i < given.size(); ++i) {
    EXPECT_EQ(back[i].place, given[i].place);
    EXPECT_EQ(back[i].key, given[i].key);
    EXPECT_EQ(back[i].text, given[i].text);
  }
  EXPECT_TRUE(problem_status({}).ok());
  EXPECT_TRUE(problems_of(absl::OkStatus()).empty());
}

TEST(Problems, AreTheMessageOfAStatusThatHasNone) {
  const auto one = problems_of(absl::NotFoundError("sweep.toml:3:1: looks like a place"));
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].text, "sweep.toml:3:1: looks like a place");
  EXPECT_EQ(one[0].place, "");
  EXPECT_FALSE(begins_with_place(absl::NotFoundError("sweep.toml:3:1: looks like a place")));
  EXPECT_TRUE(begins_with_place(placed_problem("sweep.toml:3:1", "is one")));
  EXPECT_FALSE(begins_with_place(absl::OkStatus()));
}

TEST(Problems, GetTheKeyOfWhoeverAskedForThem) {
  const absl::Status in_file =
      problem_status({{"van.obj:3:1", "", "no number"}, {"van.obj:4:2", "", "no face"}});
  const absl::Status at = at_key("model.file", in_file);
  EXPECT_EQ(std::string(at.message()),
            "model.file: van.obj:3:1: no number\nmodel.file: van.obj:4:2: no face");
  for (const Problem& problem : problems_of(at)) {
    EXPECT_EQ(problem.key, "model.file");
    EXPECT_EQ(problem.place, "");
  }
  EXPECT_TRUE(absl::IsOutOfRange(at_key("band", absl::OutOfRangeError("far"))));
  EXPECT_TRUE(at_key("band", absl::OkStatus()).ok());
  EXPECT_EQ(std::string(keyed_problem("part[2].name", "no group").message()),
            "part[2].name: no group");
}

TEST(Formula, IsWhatASpreadsheetWouldRunAndNoNumber) {
  for (const char* formula : {"=HYPERLINK(\"http://x\")", "=1+1", "+cmd|' /C calc'!A0", "-2+3",
                              "@SUM(A1)", "\t=1", "\r=1", "=", "-", "- 5 C", "+x"})
    EXPECT_TRUE(is_formula(formula)) << formula;
  for (const char* plain : {"", "hull", "a=b", "-5", "+5.25", "-1e-9", "1+1", " =1", "'=1", "-inf",
                            "2025-06-21", "\u00e9"})
    EXPECT_FALSE(is_formula(plain)) << plain;
}

}  // namespace
}  // namespace irsig
