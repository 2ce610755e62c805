// Tests light that could shine without being met: some is bounded by what it could send, some is
// allowed for as what a sample could miss.

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <numbers>

#include "core/signature/view/unseen.h"

namespace irsig {
namespace {

TEST(SmallBrightSources, ALargeDimPlaceIsAllowedForByItsSamples) {
  SmallBrightSources light;
  light.add(3, 100);  // [W/(m2 sr)], [m2]
  const SmallBrightSources::Allowance a = light.allowance(0.01);
  EXPECT_EQ(a.bound, 0);
  EXPECT_DOUBLE_EQ(a.stderr_, 2 * 0.01 * 3);
}

TEST(SmallBrightSources, ASmallMirrorCostsWhatItCouldSend) {
  SmallBrightSources light;
  light.add(1e5, 1e-6);
  const SmallBrightSources::Allowance a = light.allowance(0.01);
  EXPECT_DOUBLE_EQ(a.bound, 0.1);
  EXPECT_EQ(a.stderr_, 0);
}

// The threshold lies between the two, and the error is that of the best of all thresholds.
TEST(SmallBrightSources, EachPlaceIsCountedTheCheaperWay) {
  SmallBrightSources light;
  light.add(1e5, 1e-6);
  light.add(3, 100);
  const SmallBrightSources::Allowance a = light.allowance(0.01);
  EXPECT_DOUBLE_EQ(a.bound, 0.1);
  EXPECT_DOUBLE_EQ(a.stderr_, 0.06);
  EXPECT_DOUBLE_EQ(light.sum(), 300.1);
  EXPECT_DOUBLE_EQ(light.brightest(), 1e5);
}

// No cliff: as a mirror grows, the error rises smoothly and never above either way alone.
TEST(SmallBrightSources, GrowsWithoutACliff) {
  double last = 0;
  for (double seen_m2 = 1e-8; seen_m2 < 10; seen_m2 *= 1.1) {
    SmallBrightSources light;
    light.add(1e3, seen_m2);
    const SmallBrightSources::Allowance a = light.allowance(0.01);
    const double error = std::hypot(a.stderr_, a.bound / std::numbers::sqrt3);
    EXPECT_GE(error, last);
    EXPECT_LE(error, 1.11 * std::max(last, 1e-5 / std::numbers::sqrt3));
    EXPECT_LE(error, 2 * 0.01 * 1e3);
    EXPECT_LE(error, 1e3 * seen_m2 / std::numbers::sqrt3 * (1 + 1e-12));
    last = error;
  }
}

// Places come out from bright to dark, in whatever order they go in; numbers without a leading bit
// are the darkest.
TEST(SmallBrightSources, TheOrderOfPlacesDoesNotMatter) {
  const double radiance[] = {1e-310, 4e-308, 1e-3, 0.7, 0.9, 1, 1.24, 1.26, 5, 1e200};
  SmallBrightSources up, down;
  for (const double r : radiance) up.add(r, 1e-4 / r);
  for (auto r = std::rbegin(radiance); r != std::rend(radiance); ++r) down.add(*r, 1e-4 / *r);
  EXPECT_EQ(up.brightest(), 1e200);
  EXPECT_EQ(down.brightest(), 1e200);
  EXPECT_DOUBLE_EQ(up.sum(), 10e-4);
  EXPECT_DOUBLE_EQ(down.sum(), 10e-4);
  for (const double sample_m2 : {1e-6, 3e-5, 1e-3}) {
    EXPECT_DOUBLE_EQ(up.allowance(sample_m2).bound, down.allowance(sample_m2).bound);
    EXPECT_DOUBLE_EQ(up.allowance(sample_m2).stderr_, down.allowance(sample_m2).stderr_);
  }
  // With samples this dense all but the one far brighter place is allowed for by them.
  EXPECT_DOUBLE_EQ(up.allowance(1e-6).bound, 1e-4);
  EXPECT_DOUBLE_EQ(up.allowance(1e-6).stderr_, 2 * 1e-6 * 5);
}

TEST(SmallBrightSources, WhatIsDarkOrHasNoAreaIsNothing) {
  SmallBrightSources light;
  light.add(0, 1);
  light.add(1, 0);
  EXPECT_EQ(light.allowance(1).stderr_, 0);
  EXPECT_EQ(light.brightest(), 0);
}

}  // namespace
}  // namespace irsig
