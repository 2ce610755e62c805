// Tests schedules that repeat every day, at any instant and at knots.
#include "core/thermal/day_schedule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace irsig {
namespace {

constexpr double kHourS = 3600, kDayS = 86400;
// Some day: 20 000 after 1970.
constexpr double kMidnightS = 20000 * kDayS;

DaySchedule three(bool steps) {
  return {{{2 * kHourS, 290}, {8 * kHourS, 320}, {20 * kHourS, 300}}, steps};
}
double at_hour(const DaySchedule& schedule, double hour) {
  return value_at(schedule, kMidnightS + hour * kHourS);
}

TEST(DaySchedule, LinearOverMidnight) {
  const DaySchedule s = three(false);
  EXPECT_DOUBLE_EQ(at_hour(s, 2), 290);
  EXPECT_DOUBLE_EQ(at_hour(s, 5), 305);
  EXPECT_DOUBLE_EQ(at_hour(s, 14), 310);
  // The line goes from 20 h to 2 h of the next day in 6 h: midnight lies at two thirds.
  EXPECT_NEAR(at_hour(s, 24), 300 - 10 * 4.0 / 6, 1e-9);
  EXPECT_NEAR(at_hour(s, 0), 300 - 10 * 4.0 / 6, 1e-9);
  EXPECT_NEAR(at_hour(s, 23.9999), at_hour(s, 24.0001), 0.01);
  EXPECT_NEAR(at_hour(s, 5 + 24 * 365), 305, 1e-9);
  EXPECT_NEAR(value_at(s, -19 * kHourS), 305, 1e-9) << "before 1970";
}

TEST(DaySchedule, StepsHoldUntilTheNextTime) {
  const DaySchedule s = three(true);
  EXPECT_EQ(at_hour(s, 1.999), 300) << "since the evening before";
  EXPECT_EQ(at_hour(s, 2), 290);
  EXPECT_EQ(at_hour(s, 7.999), 290);
  EXPECT_EQ(at_hour(s, 8), 320);
  EXPECT_EQ(at_hour(s, 24), 300);
}

TEST(DaySchedule, OneTimeIsAConstant) {
  for (const bool steps : {false, true})
    for (const double hour : {0.0, 6.9, 7.0, 23.0})
      EXPECT_EQ(at_hour({{{7 * kHourS, 295.5}}, steps}, hour), 295.5);
}

TEST(DaySchedule, ItsTimesOfSeveralDays) {
  const auto found = times_between(three(true), kMidnightS + 8 * kHourS, kMidnightS + 34 * kHourS);
  const double expected[] = {20, 26, 32};
  ASSERT_EQ(found.size(), 3U) << "of 8 h the instant itself is excluded";
  for (int i = 0; i < 3; ++i) EXPECT_EQ(found[i], kMidnightS + expected[i] * kHourS);
}

TEST(DaySchedule, AtKnotsStepsJumpAndLinesDoNot) {
  const std::vector<double> knot = {kMidnightS, kMidnightS + 2 * kHourS, kMidnightS + 5 * kHourS,
                                    kMidnightS + 8 * kHourS, kMidnightS + 24 * kHourS};
  const auto steps = at_knots(three(true), knot);
  EXPECT_EQ(steps[0].after, 300);
  EXPECT_EQ(steps[1].before, 300);
  EXPECT_EQ(steps[1].after, 290);
  EXPECT_EQ(steps[2].before, 290);
  EXPECT_EQ(steps[2].after, 290);
  EXPECT_EQ(steps[3].after, 320);
  for (const ScheduleAtKnot& at : at_knots(three(false), knot)) EXPECT_EQ(at.before, at.after);
  EXPECT_DOUBLE_EQ(at_knots(three(false), knot)[2].after, 305);
}

// A time that is no knot counts as the nearest one.
TEST(DaySchedule, AStepBesideAKnotIsAtThatKnot) {
  for (const double off_s : {-40.0, 40.0}) {
    const DaySchedule s{{{8 * kHourS + off_s, 320}, {20 * kHourS, 300}}, true};
    const auto found =
        at_knots(s, std::vector<double>{kMidnightS + 7 * kHourS, kMidnightS + 8 * kHourS,
                                        kMidnightS + 9 * kHourS});
    EXPECT_EQ(found[0].after, 300);
    EXPECT_EQ(found[1].before, 300);
    EXPECT_EQ(found[1].after, 320);
    EXPECT_EQ(found[2].before, 320);
  }
}

TEST(DaySchedule, WhatIsNone) {
  EXPECT_TRUE(check_schedule(three(true)).ok());
  EXPECT_FALSE(check_schedule({}).ok());
  EXPECT_FALSE(check_schedule({{{kDayS, 290}}, true}).ok());
  EXPECT_FALSE(check_schedule({{{-1, 290}}, true}).ok());
  EXPECT_FALSE(check_schedule({{{3600, 290}, {3600, 291}}, true}).ok());
  EXPECT_FALSE(check_schedule({{{3600, NAN}}, true}).ok());
}

}  // namespace
}  // namespace irsig
