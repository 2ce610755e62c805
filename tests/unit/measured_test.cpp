#include "core/accuracy/measured.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace irsig {
namespace {

Measured some() {
  Measured m{-100, 3, {}};
  m.of(BoundOf::kTruncation) = 1;
  m.of(BoundOf::kSky) = 2;
  m.of(BoundOf::kMoved) = 4;
  return m;
}

TEST(Measured, TheErrorIsThatOfSamplesAndAUniformBias) {
  EXPECT_DOUBLE_EQ(some().bias_bound(), 7);
  EXPECT_DOUBLE_EQ(some().numerical_error(), std::sqrt(9 + 49.0 / 3));
  EXPECT_EQ((Measured{5, 2, {}}).numerical_error(), 2);
}

TEST(Measured, TheSharesOfItsSquareAddUpToOne) {
  double sum = some().sampled_fraction();
  for (std::size_t i = 0; i < kBounds; ++i) sum += some().share(static_cast<BoundOf>(i));
  EXPECT_NEAR(sum, 1, 1e-15);
  EXPECT_NEAR(some().share(BoundOf::kMoved), 4 * 7.0 / 3 / (9 + 49.0 / 3), 1e-15);
  EXPECT_EQ(Measured().share(BoundOf::kSky), 0) << "nothing is uncertain";
}

TEST(Measured, AScaleHasNoSignForErrors) {
  const Measured m = scaled(some(), -2);
  EXPECT_EQ(m.value, 200);
  EXPECT_EQ(m.stderr_, 6);
  EXPECT_EQ(m.of(BoundOf::kSky), 4);
  EXPECT_DOUBLE_EQ(m.numerical_error(), 2 * some().numerical_error());
}

TEST(Measured, SamplesAddAsSquaresBoundsAsTheyAre) {
  const Measured other{10, 4, {}};
  const Measured both = sum(some(), other);
  EXPECT_EQ(both.value, -90);
  EXPECT_DOUBLE_EQ(both.stderr_, 5);
  EXPECT_EQ(both.bias_bound(), 7);
  // A row and itself: what is sampled cancels on shared paths, what is bounded does not.
  const Measured none = difference(some(), some(), 0);
  EXPECT_EQ(none.value, 0);
  EXPECT_EQ(none.stderr_, 0);
  EXPECT_EQ(none.bias_bound(), 14);
}

TEST(Measured, AMeanOfEqualRowsKeepsTheirBias) {
  const std::array rows{some(), some(), some(), some()};
  const std::array weight{0.25, 0.25, 0.25, 0.25};
  const Measured mean = weighted_sum(weight, rows);
  EXPECT_DOUBLE_EQ(mean.value, -100);
  EXPECT_DOUBLE_EQ(mean.stderr_, 1.5);
  EXPECT_DOUBLE_EQ(mean.bias_bound(), 7);
  // Weights of an extrapolation: one of them is negative.
  const std::array beyond{2.0, -1.0, 0.0, 0.0};
  EXPECT_DOUBLE_EQ(weighted_sum(beyond, rows).bias_bound(), 21);
}

TEST(Measured, WhatAnErrorHoldsBesidesIsGivenToOneBound) {
  Measured known = some();
  known.of(BoundOf::kSky) = 0;
  const Measured whole = with_rest(known, some().numerical_error(), BoundOf::kDepth);
  EXPECT_NEAR(whole.of(BoundOf::kDepth), 2, 1e-12);
  EXPECT_NEAR(whole.numerical_error(), some().numerical_error(), 1e-12);
  // An error that is rounded to less than its parts holds nothing else.
  EXPECT_EQ(with_rest(some(), 3, BoundOf::kDepth).of(BoundOf::kDepth), 0);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(with_rest(some(), unknown, BoundOf::kDepth).numerical_error()));
}

TEST(Measured, TheLimitIsTheLargestPartOfTheError) {
  EXPECT_EQ(limiting_part({}), "");
  EXPECT_EQ(limiting_part({5, 2, {}, 0}), "sampling");
  EXPECT_EQ(limiting_part(some()), "moved");
  // A bound counts with all bounds: 2 x 3 / 3 is less than 1.5^2, and 2 x 4 / 3 more.
  Measured m{-100, 1.5, {}, 0};
  m.of(BoundOf::kTemperature) = 2;
  m.of(BoundOf::kTruncation) = 1;
  EXPECT_EQ(limiting_part(m), "sampling");
  m.of(BoundOf::kTruncation) = 1.9;
  EXPECT_EQ(limiting_part(m), "temperature");
  // The estimate and the bound of undersampling are one part.
  Measured unseen{100, 1, {}, 0.9};
  unseen.of(BoundOf::kUnseen) = 1;
  EXPECT_EQ(limiting_part(unseen), "undersampling");
  EXPECT_EQ(limiting_part({1, std::numeric_limits<double>::quiet_NaN(), {}, 0}), "");
}

TEST(Measured, EveryBoundHasAName) {
  for (std::size_t i = 0; i < kBounds; ++i)
    EXPECT_FALSE(info_of(static_cast<BoundOf>(i)).name.empty());
  EXPECT_TRUE(info_of(BoundOf::kTruncation).shared_between_bands);
  EXPECT_FALSE(info_of(BoundOf::kQuadrature).shared_between_bands);
}

}  // namespace
}  // namespace irsig
