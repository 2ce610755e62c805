// core/base: checks that say what they compared, and table look-up with stated bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/check.h"
#include "core/base/file_errors.h"
#include "core/base/next_large.h"
#include "core/base/sobol.h"
#include "core/base/table.h"

namespace irsig {
namespace {

TEST(CheckDeathTest, PrintsTheExpressionAndBothOperands) {
  const double temperature_k = -3.5;
  EXPECT_DEATH(
      IRSIG_CHECK(temperature_k >= 0.0),
      "base_test.cpp:[0-9]+: IRSIG_CHECK\\(temperature_k >= 0.0\\) failed: -3.5 against 0");
  const std::vector<int> empty;
  EXPECT_DEATH(IRSIG_CHECK(empty.size() != 0), "0 against 0");
  EXPECT_DEATH(IRSIG_CHECK(std::nan("") == 1.0), "nan against 1");
  const int* nothing = nullptr;
  EXPECT_DEATH(IRSIG_CHECK(nothing), "IRSIG_CHECK\\(nothing\\)");
}

TEST(Check, HoldsInEveryForm) {
  int evaluated = 0;
  IRSIG_CHECK(++evaluated == 1);
  EXPECT_EQ(evaluated, 1);
  IRSIG_CHECK(2 + 2 == 4);
  IRSIG_CHECK(-1 < std::size_t{1});  // by value, not by conversion to unsigned
  IRSIG_CHECK(std::string("a") != "b");
  IRSIG_CHECK(evaluated);
  if (evaluated == 1)
    IRSIG_CHECK(true);
  else
    FAIL() << "a check is one statement";
}

const std::vector<double> kX{1.0, 2.0, 4.0, 4.5};
const std::vector<double> kY{10.0, 0.1, 0.3, -1.0};

TEST(Table, PointsAreExactAndSegmentsLinear) {
  for (std::size_t i = 0; i < kX.size(); ++i) {
    EXPECT_EQ(interpolate_or(kX, kY, kX[i], -99), kY[i]);
  }
  EXPECT_DOUBLE_EQ(interpolate_or(kX, kY, 3.0, -99), 0.2);
  EXPECT_EQ(locate(kX, 4.0).index, 2u);
  EXPECT_EQ(locate(kX, 4.5).index, 2u);
  EXPECT_EQ(locate(kX, 4.5).fraction, 1.0);
  EXPECT_EQ(locate(kX, 1.0).index, 0u);
}

TEST(Table, OutsideIsWhatTheCallerSays) {
  EXPECT_EQ(interpolate_or(kX, kY, 0.999, -99), -99);
  EXPECT_EQ(interpolate_or(kX, kY, 4.501, 0), 0);
  EXPECT_EQ(interpolate_or(kX, kY, std::nan(""), 7), 7);
}

TEST(TableDeathTest, LocateRefusesTheOutside) {
  EXPECT_DEATH((void)locate(kX, 0.5), "0.5 against 1");
  EXPECT_DEATH((void)locate(kX, 5.0), "5 against 4.5");
  EXPECT_DEATH((void)locate_uniform(0, 0.1, 11, 1.01), "steps <= last");
}

// The build has to end a program that would otherwise compute with 6.95e-310 K (CMakeLists.txt).
TEST(StandardLibraryDeathTest, AnEmptyOptionalAndAnIndexPastTheEndEndTheProgram) {
  const std::optional<double> nothing;
  const auto take = [](double value) { std::printf("%g\n", value); };
  EXPECT_DEATH(take(*nothing), "_M_is_engaged");
  const std::vector<int> empty;
  volatile std::size_t index = 0;
  EXPECT_DEATH(take(empty[index]), "size\\(\\)");
}

TEST(Table, UniformAgreesWithTheSearch) {
  const double first = 3.0;
  const double step = 0.05;
  std::vector<double> x;
  for (int i = 0; i <= 40; ++i) x.push_back(first + i * step);
  for (double at = 3.0; at <= 5.0; at += 0.0037) {
    const TablePosition searched = locate(x, at);
    const TablePosition computed = locate_uniform(first, step, x.size(), at);
    EXPECT_NEAR(static_cast<double>(searched.index) + searched.fraction,
                static_cast<double>(computed.index) + computed.fraction, 1e-12);
  }
  // A grid's own last point, whatever its rounding, is inside.
  EXPECT_EQ(locate_uniform(first, step, x.size(), x.back()).index, 39u);
  EXPECT_NEAR(locate_uniform(first, step, x.size(), x.back()).fraction, 1.0, 1e-12);
}

TEST(Table, AbscissaeAreFiniteAndIncreasing) {
  EXPECT_TRUE(is_abscissa(kX));
  EXPECT_FALSE(is_abscissa(std::vector<double>{1.0}));
  EXPECT_FALSE(is_abscissa(std::vector<double>{1.0, 1.0}));
  EXPECT_FALSE(is_abscissa(std::vector<double>{2.0, 1.0}));
  EXPECT_FALSE(is_abscissa(std::vector<double>{1.0, std::nan(""), 3.0}));
  EXPECT_FALSE(is_abscissa(std::vector<double>{1.0, std::numeric_limits<double>::infinity()}));
}

TEST(FileErrors, ALineForEachWhateverItQuotes) {
  FileErrors errors("f");
  errors.add(1, 2, "\"a\nb\x1b[31m\" is wrong");
  errors.add(3, 4, "so is this");
  EXPECT_EQ(errors.status().message(), "f:1:2: \"a?b?[31m\" is wrong\nf:3:4: so is this");
}

// Expected: what walking the list finds, for lists of any length, from any place.
TEST(NextLarge, IsTheOneThatWalkingFinds) {
  std::uint64_t state = 1;
  for (const std::size_t size : {0u, 1u, 2u, 3u, 7u, 8u, 9u, 100u, 1000u}) {
    std::vector<double> value;
    for (std::size_t i = 0; i < size; ++i)
      value.push_back(static_cast<double>((state = mix64(state)) % 50));
    const NextLarge list(value);
    for (const double least : {-1.0, 0.0, 7.0, 45.0, 49.0, 50.0}) {
      const auto enough = [&](double x) { return x >= least; };
      for (std::size_t from = 0; from <= size; from += 1 + size / 40) {
        const auto walked =
            std::find_if(value.begin() + static_cast<std::ptrdiff_t>(from), value.end(), enough);
        EXPECT_EQ(list.next(from, enough), static_cast<std::size_t>(walked - value.begin()))
            << size << " from " << from << ", " << least;
      }
    }
  }
}

}  // namespace
}  // namespace irsig
