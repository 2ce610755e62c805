// Lists of months and hours, and names of hot parts, as `irsig init` reads them.
#include "planning/sweep_template.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SweepTemplate, ReadsListsOfNumbersAndRanges) {
  EXPECT_THAT(*numbers_of_list("1-3,7", 1, 12), ElementsAre(1, 2, 3, 7));
  EXPECT_THAT(*numbers_of_list("12", 1, 12), ElementsAre(12));
  EXPECT_THAT(*numbers_of_list("18,0", 0, 23), ElementsAre(18, 0));
  EXPECT_EQ(numbers_of_list("0-23", 0, 23)->size(), 24U);
  for (const char* wrong :
       {"", "0-12", "13", "3-1", "1,,2", "1-2-3", "jan", "1,1", "2,1-3", "-1"}) {
    const auto list = numbers_of_list(wrong, 1, 12);
    ASSERT_FALSE(list.ok()) << wrong;
    EXPECT_THAT(std::string(list.status().message()), HasSubstr("expected numbers from 1 to 12"));
  }
  EXPECT_THAT(std::string(numbers_of_list("2,1-3", 1, 12).status().message()),
              HasSubstr("2 is there twice"));
}

TEST(SweepTemplate, KnowsHotPartsByTheirNames) {
  for (const char* hot : {"Funnel_top", "main engine", "EXHAUST", "smokestack"})
    EXPECT_TRUE(sounds_hot(hot)) << hot;
  for (const char* cold : {"hull", "deck", "mast", "", "antenna"})
    EXPECT_FALSE(sounds_hot(cold)) << cold;
}

}  // namespace
}  // namespace irsig
