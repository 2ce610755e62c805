// Deviations between meshes, and the limit of ever more facets: closed forms, and synthetic values
// whose errors are known.
#include "core/study/mesh_convergence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace irsig {
namespace {

using std::numbers::pi;

TEST(MeshDeviation, IsRelativeAndHasTheErrorsOfBoth) {
  const MeshDeviation d = deviation({2.2, 0.06}, {2, 0.04});
  EXPECT_DOUBLE_EQ(d.value, 2.2 / 2 - 1);
  EXPECT_DOUBLE_EQ(d.error, 1.1 * std::hypot(0.06 / 2.2, 0.04 / 2));
  EXPECT_DOUBLE_EQ(d.significance(), d.value / d.error);
  EXPECT_DOUBLE_EQ(deviation({1, 0.1}, {2, 0.2}).value, -0.5);
  EXPECT_GT(deviation({1, 0.1}, {2, 0.2}).significance(), 0) << "of a negative deviation, too";
}

TEST(MeshDeviation, OfExactValues) {
  EXPECT_EQ(deviation({3, 0}, {3, 0}).significance(), 0);
  EXPECT_TRUE(std::isinf(deviation({3, 0}, {2, 0}).significance()));
  EXPECT_EQ(deviation({0, 0}, {0, 0}).value, 0) << "seen by neither";
}

TEST(MeshDeviation, SummaryOverViews) {
  const std::vector<MeshDeviation> views{{0.03, 0.01}, {-0.04, 0.02}, {0, 0.01}};
  const DeviationSummary s = summary_of(views);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt((9e-4 + 16e-4) / 3));
  EXPECT_DOUBLE_EQ(s.rms_error, std::sqrt((1e-4 + 4e-4 + 1e-4) / 3));
  EXPECT_DOUBLE_EQ(s.rms_significance, std::sqrt((9.0 + 4.0) / 3));
  EXPECT_EQ(s.largest, 1u);
  EXPECT_FALSE(s.significant) << "chi-square 13 of 3 degrees of freedom: below 3 + 5 sqrt(6)";
  const std::vector<MeshDeviation> clear{{0.03, 0.01}, {-0.04, 0.01}, {0, 0.01}};
  EXPECT_TRUE(summary_of(clear).significant) << "25";
}

// A regular polygon of m corners in the unit circle has the area m / 2 sin(2 pi / m) = pi (1 - x +
// 3/10 x^2 - ...), x = (2 pi / m)^2 / 6. Facets of a solid around it grow as m^2. With x = 16 f, 4
// f and f the differences are 12 f - 72 f^2 and 3 f - 9/2 f^2, each over pi: their ratio 4 (1 - 9/2
// f) makes the order 1 - 9/2 f / log 4, and what Richardson leaves is 24/5 f^2. Next terms are f
// times these, times some ten: 0.001 x 10.
TEST(MeshLimit, OfPolygonsIsTheCircle) {
  std::vector<double> facets;
  std::vector<std::vector<MeshValue>> area(1);
  for (const double m : {20, 40, 80}) {
    facets.push_back(m * m);
    area[0].push_back({m / 2 * std::sin(2 * pi / m), 0});
  }
  ASSERT_TRUE(varies(area));
  const auto limit = mesh_limit(facets, area);
  ASSERT_TRUE(limit);
  const double f = std::pow(2 * pi / 80, 2) / 6;
  EXPECT_NEAR(limit->order, 1 - 4.5 * f / std::log(4), 0.02 * 4.5 * f);
  EXPECT_NEAR(limit->limit[0].value, pi * (1 + 4.8 * f * f), 0.02 * pi * 4.8 * f * f);
  EXPECT_NEAR(limit->rms_off(facets[2]), f, 6 * f * f);
  EXPECT_NEAR(limit->rms_off(facets[0]), 16 * f, 0.3 * 256 * f * f + 6 * f * f);
}

// A regular polygon of 2 n sides in the unit circle, turned about a diagonal (Archimedes): 4 pi
// cos(pi / 2n), whose second term is 5e-5 at n = 16. Larger spheres are further views of the same
// mesh.
TEST(MeshLimit, OfInscribedSpheresIsTheSphere) {
  std::vector<double> facets;
  std::vector<std::vector<MeshValue>> area(3);
  for (const double n : {16, 32, 64, 128}) {
    facets.push_back(n * n);
    for (int view = 0; view < 3; ++view)
      area[static_cast<std::size_t>(view)].push_back(
          {(1 + view) * 4 * pi * std::cos(pi / (2 * n)), 1e-3});
  }
  const auto limit = mesh_limit(facets, area);
  ASSERT_TRUE(limit);
  EXPECT_EQ(limit->degrees_of_freedom, 5u);
  EXPECT_LE(limit->order_low, 1);
  EXPECT_GE(limit->order_high, 1);
  EXPECT_FALSE(limit->order_high_open);
  for (int view = 0; view < 3; ++view) {
    const MeshValue& sphere = limit->limit[static_cast<std::size_t>(view)];
    EXPECT_NEAR(sphere.value, (1 + view) * 4 * pi, 3 * sphere.error);
    EXPECT_LT(sphere.error, 3e-3) << "about as well known as the values";
  }
}

class SyntheticMeshes : public testing::Test {
 protected:
  // 6 views on 4 meshes: 100 + factor of the view / facets x 1000.
  std::vector<std::vector<MeshValue>> values(double factor) {
    std::vector<std::vector<MeshValue>> out;
    for (int view = 0; view < 6; ++view) {
      out.emplace_back();
      for (const double n : facets_)
        out.back().push_back(
            {100 + factor * (view - 2) * 1000 / n + error_ * normal_(random_), error_});
    }
    return out;
  }

  const std::vector<double> facets_{1000, 2000, 4000, 8000};
  const double error_ = 0.01;
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

// One sigma: 68 %. Of 400 sets within 3 standard deviations of that, 7 %.
TEST_F(SyntheticMeshes, RangesHoldTheTruthAsOftenAsOneSigmaDoes) {
  int order = 0, limits = 0;
  for (int set = 0; set < 400; ++set) {
    const auto limit = mesh_limit(facets_, values(0.1));
    ASSERT_TRUE(limit);
    order += limit->order_low <= 1 && 1 <= limit->order_high ? 1 : 0;
    limits += std::abs(limit->limit[5].value - 100) <= limit->limit[5].error ? 1 : 0;
  }
  // Scatter that is larger than the errors by chance widens the ranges, smaller does not narrow
  // them: somewhat more than 68 %.
  EXPECT_GT(order, 400 * 0.61);
  EXPECT_LT(order, 400 * 0.85);
  // The error of a limit takes the order's range as a whole: never too small.
  EXPECT_GT(limits, 400 * 0.61);
}

TEST_F(SyntheticMeshes, WhatIsNothingButErrorsDoesNotVary) {
  int found = 0;
  for (int set = 0; set < 400; ++set) found += varies(values(0)) ? 1 : 0;
  // Chi-square of 18 degrees of freedom above 48: 1.5e-4.
  EXPECT_LE(found, 1);
  EXPECT_TRUE(varies(values(0.1)));
}

TEST_F(SyntheticMeshes, NoLimitWithoutAnOrder) {
  EXPECT_FALSE(mesh_limit(std::vector{1000.0, 2000.0},
                          std::vector<std::vector<MeshValue>>{{{1, 0.01}, {2, 0.01}}}))
      << "two meshes";
  EXPECT_FALSE(mesh_limit(std::vector{1000.0, 2000.0, 2000.0},
                          std::vector<std::vector<MeshValue>>{{{1, 0.01}, {2, 0.01}, {3, 0.01}}}))
      << "two of one density";
  EXPECT_FALSE(mesh_limit(std::vector{1000.0, 2000.0, 4000.0},
                          std::vector<std::vector<MeshValue>>{{{1, 0}, {1.1, 0}, {1, 0}}}))
      << "neither up nor down";
  EXPECT_FALSE(mesh_limit(std::vector{1000.0, 2000.0, 4000.0},
                          std::vector<std::vector<MeshValue>>{{{1, 0}, {2, 0}, {3, 0}}}))
      << "as the logarithm of the facets: without end";
}

// Where only the coarsest mesh is off, any fast order will do; the limit is known all the same.
TEST_F(SyntheticMeshes, AnOrderOpenAbove) {
  const auto limit =
      mesh_limit(facets_, std::vector<std::vector<MeshValue>>{
                              {{101, 0.01}, {100.001, 0.01}, {99.999, 0.01}, {100, 0.01}}});
  ASSERT_TRUE(limit);
  EXPECT_TRUE(limit->order_high_open);
  EXPECT_EQ(limit->order_high, kMostOrder);
  EXPECT_NEAR(limit->limit[0].value, 100, limit->limit[0].error);
  EXPECT_LT(limit->limit[0].error, 0.05) << "of the 1 by which the coarsest mesh is off";
}

}  // namespace
}  // namespace irsig
