// Rationale: the cases on which radiometric codes break must hold on every machine and after every
// change.
// Expected: the worst error of each case within its bound. Both are stated with the case.
// Source: verify/cases, docs/evidence/stability.md.
#include "verify/cases/hard_case.h"

#include <gtest/gtest.h>

#include <set>

namespace irsig {

void PrintTo(const HardCase& c, std::ostream* out) { *out << c.id(); }

namespace {

class Hard : public testing::TestWithParam<HardCase> {};

TEST_P(Hard, Holds) {
  const HardCase& c = GetParam();
  const auto finding = c.run(Effort::kShort);
  ASSERT_TRUE(finding.ok()) << finding.status();
  EXPECT_GT(finding->checks, 0u) << "a case that checks nothing";
  EXPECT_LE(finding->worst_error, finding->bound)
      << c.what << "\nat: " << finding->where << "\nthe bound: " << c.reason;
  std::printf("%s: worst %.3g, bound %.3g, %llu checks, %s\n", c.id().c_str(), finding->worst_error,
              finding->bound, static_cast<unsigned long long>(finding->checks),
              finding->where.c_str());
}

INSTANTIATE_TEST_SUITE_P(, Hard, testing::ValuesIn(hard_cases()),
                         [](const auto& of) { return of.param.group + "_" + of.param.name; });

TEST(HardCases, HaveNamesAndReasonsOfTheirOwn) {
  std::set<std::string> ids;
  for (const HardCase& c : hard_cases()) {
    EXPECT_TRUE(ids.insert(c.id()).second) << c.id();
    EXPECT_GT(c.what.size(), 10u) << c.id();
    EXPECT_GT(c.reason.size(), 10u) << c.id();
  }
  EXPECT_GE(ids.size(), 40u);
}

}  // namespace
}  // namespace irsig
