#include "verify/cases/selftest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "verify/cases/groups.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

HardCase some_case(const char* name) {
  return {"group", name, "what is compared", "why the bound", nullptr};
}

CaseResult result(double worst, double bound, std::uint64_t checks = 1) {
  return {some_case("a"), Finding{worst, bound, checks, "at 3, \"here\""}, 0.5};
}

TEST(Selftest, PassesOnlyWhatHolds) {
  EXPECT_TRUE(result(0, 0).passed());
  EXPECT_TRUE(result(1, 1).passed());
  EXPECT_FALSE(result(1.0000001, 1).passed());
  EXPECT_FALSE(result(std::nan(""), 1).passed()) << "an error that is not a number";
  EXPECT_FALSE(result(0, std::nan("")).passed()) << "a bound that is not a number";
  EXPECT_FALSE(result(0, 1, 0).passed()) << "nothing was checked";
  const CaseResult impossible{some_case("a"), absl::InternalError("no such mesh"), 0};
  EXPECT_FALSE(impossible.passed());
  EXPECT_THAT(table_row(impossible), HasSubstr("no such mesh"));
  EXPECT_THAT(csv_row(impossible), HasSubstr(",no,"));
}

TEST(Selftest, SaysWhyACaseFails) {
  EXPECT_THAT(table_row(result(2, 1)), HasSubstr("NO"));
  EXPECT_THAT(table_row(result(2, 1)), HasSubstr("at 3"));
  EXPECT_THAT(table_row(result(2, 1)), HasSubstr("why the bound"));
  EXPECT_THAT(table_row(result(1, 2)), Not(HasSubstr("why the bound")));
  EXPECT_THAT(table_row(result(1, 2, 0)), HasSubstr("nothing was checked"));
}

TEST(Selftest, CsvQuotes) {
  EXPECT_THAT(csv_row(result(2, 1)), HasSubstr("\"at 3, \"\"here\"\"\""));
}

TEST(Selftest, FiltersByGroupAndName) {
  const std::vector<HardCase> cases = {some_case("edge_rays"), some_case("vertex_rays"),
                                       some_case("other")};
  EXPECT_EQ(matching(cases, "*").size(), 3u);
  EXPECT_EQ(matching(cases, "group").size(), 3u);
  EXPECT_EQ(matching(cases, "*_rays").size(), 2u);
  EXPECT_EQ(matching(cases, "group/vertex*").size(), 1u);
  EXPECT_EQ(matching(cases, "nothing").size(), 0u);
}

TEST(Worst, KeepsTheLargestAndNeverLosesANan) {
  Worst worst(1);
  worst.see(0.5, [] { return "a"; });
  worst.see(0.25, [] { return "b"; });
  EXPECT_EQ(worst.finding().where, "a");
  EXPECT_TRUE(worst.finding().holds());
  worst.see(std::nan(""), [] { return "c"; });
  worst.see(0.75, [] { return "d"; });
  EXPECT_EQ(worst.finding().where, "c");
  EXPECT_FALSE(worst.finding().holds());
  EXPECT_EQ(worst.finding().checks, 4u);
  Worst broken(std::numeric_limits<double>::max());
  broken.require(false, [] { return "never"; });
  EXPECT_FALSE(broken.finding().holds());
}

}  // namespace
}  // namespace irsig
