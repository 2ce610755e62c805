// Rationale: hot water is computed from a potential and a dipole surface; no line list is there to
// fall back on. Expected: levels within 0.1 cm-1 of the observed ones, the partition sum at 296 K
// within 0.1 %, the dipole moment's sum rule, and symmetry of the eigensolver.
// Source: observed levels of H2 16O and HDO as published (IUPAC, Tennyson et al. 2013); partition
// sum 174.58 at 296 K.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gas/lines/joint_terms.h"
#include "core/gas/lines/lowest_eigenstates.h"
#include "core/gas/lines/water_levels.h"
#include "core/gas/lines/water_surface.h"

namespace irsig {
namespace {

TEST(WaterLines, SurfaceHasItsMinimumAndItsBarrier) {
  const double angle = std::acos(-0.2478);
  const double least = water_potential_cm1({0.9579, 0.9579, std::cos(angle)});
  EXPECT_NEAR(least, 0, 1);
  for (const double d : {-0.02, 0.02}) {
    EXPECT_GT(water_potential_cm1({0.9579 + d, 0.9579, std::cos(angle)}), least);
    EXPECT_GT(water_potential_cm1({0.9579, 0.9579, std::cos(angle + d)}), least);
    // The two hydrogens are alike.
    EXPECT_NEAR(water_potential_cm1({0.9579 + d, 0.9579, -0.3}),
                water_potential_cm1({0.9579, 0.9579 + d, -0.3}), 1e-6);
  }
  EXPECT_NEAR(water_potential_cm1({0.933, 0.933, -1}), 11128, 30);  // straight
  const WaterCharges q = water_charges({1.0, 0.95, -0.3}), r = water_charges({0.95, 1.0, -0.3});
  EXPECT_NEAR(q.first, r.second, 1e-12);
  EXPECT_NEAR(q.second, r.first, 1e-12);
}

TEST(WaterLines, EigenvectorsOfARandomMatrix) {
  constexpr std::size_t kSize = 120;
  std::vector<double> a(kSize * kSize);
  double x = 0.3;
  for (std::size_t i = 0; i < kSize; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      x = 3.9 * x * (1 - x);
      a[i * kSize + j] = a[j * kSize + i] =
          100 * (x - 0.5) + (i == j ? 20.0 * static_cast<double>(i % 7) : 0);
    }
  const LowestEigenstates all = lowest_eigenstates(a, kSize, 1e9);
  ASSERT_EQ(all.value.size(), kSize);
  double trace = 0, sum = 0;
  for (std::size_t i = 0; i < kSize; ++i) trace += a[i * (kSize + 1)], sum += all.value[i];
  EXPECT_NEAR(sum, trace, 1e-8);
  for (std::size_t n = 0; n < kSize; n += 7) {
    const double* v = &all.vector[n * kSize];
    for (std::size_t i = 0; i < kSize; ++i) {
      double product = 0;
      for (std::size_t j = 0; j < kSize; ++j) product += a[i * kSize + j] * v[j];
      EXPECT_NEAR(product, all.value[n] * v[i], 1e-8);
    }
    for (std::size_t m = 0; m <= n; ++m) {
      double along = 0;
      for (std::size_t i = 0; i < kSize; ++i) along += v[i] * all.vector[m * kSize + i];
      EXPECT_NEAR(along, m == n ? 1 : 0, 1e-9);
    }
  }
  const LowestEigenstates lowest = lowest_eigenstates(a, kSize, all.value[40] + 1e-6);
  EXPECT_EQ(lowest.value.size(), 41U);
  EXPECT_EQ(lowest.vector.size(), 41U * kSize);
}

// Two levels of the same matrix elements, and a matrix that is diagonal already.
TEST(WaterLines, EigenvectorsOfADiagonal) {
  const std::vector<double> a = {3, 0, 0, 0, 1, 0, 0, 0, 2};
  const LowestEigenstates of = lowest_eigenstates(a, 3, 10);
  EXPECT_EQ(of.value, (std::vector<double>{1, 2, 3}));
  for (std::size_t n = 0; n < 3; ++n)
    EXPECT_NEAR(std::abs(of.vector[n * 3 + std::vector<std::size_t>{1, 2, 0}[n]]), 1, 1e-12);
}

class WaterMolecule : public testing::Test {
 protected:
  static const WaterBasis& basis(WaterKind kind) {
    static const WaterBasis h2o({WaterKind::kH2o, 18000, 14}), hdo({WaterKind::kHdo, 12000, 3});
    return kind == WaterKind::kH2o ? h2o : hdo;
  }
};

TEST_F(WaterMolecule, HasTheObservedLevels) {
  const WaterBasis& b = basis(WaterKind::kH2o);
  const std::vector<double> even = {0, 1594.75, 3151.63, 3657.05, 4666.79},
                            odd = {3755.93, 5331.27, 6871.52, 7249.82};
  for (std::size_t i = 0; i < even.size(); ++i)
    EXPECT_NEAR(water_levels(b, 0, 0, 0, 9000).energy_cm1.at(i), even[i], 0.1);
  for (std::size_t i = 0; i < odd.size(); ++i)
    EXPECT_NEAR(water_levels(b, 0, 0, 1, 9000).energy_cm1.at(i), odd[i], 0.1);
  // J Ka Kc: 101, 111, 110; 321, 330; 550.
  EXPECT_NEAR(water_levels(b, 1, 0, 0, 9000).energy_cm1.at(0), 23.794, 0.01);
  EXPECT_NEAR(water_levels(b, 1, 0, 1, 9000).energy_cm1.at(0), 37.137, 0.01);
  EXPECT_NEAR(water_levels(b, 1, 1, 1, 9000).energy_cm1.at(0), 42.372, 0.01);
  EXPECT_NEAR(water_levels(b, 3, 0, 0, 9000).energy_cm1.at(1), 212.156, 0.02);
  EXPECT_NEAR(water_levels(b, 3, 1, 1, 9000).energy_cm1.at(1), 285.418, 0.03);
  // Spins of the two protons: 000 and 111 are para, 101 and 110 ortho.
  EXPECT_EQ(water_levels(b, 0, 0, 0, 9000).nuclear_weight, 1);
  EXPECT_EQ(water_levels(b, 1, 0, 0, 9000).nuclear_weight, 3);
  EXPECT_EQ(water_levels(b, 1, 0, 1, 9000).nuclear_weight, 1);
  EXPECT_EQ(water_levels(b, 1, 1, 1, 9000).nuclear_weight, 3);
  // 12 0 12, of its nuclear weight 1.
  double least = 1e9;
  for (const std::size_t p : {0, 1})
    for (const std::size_t s : {0, 1})
      least = std::min(least, water_levels(b, 12, p, s, 9000).energy_cm1.at(0));
  EXPECT_NEAR(least, 1557.85, 0.1);
}

TEST_F(WaterMolecule, WithDeuteriumHasTheObservedLevels) {
  const WaterBasis& b = basis(WaterKind::kHdo);
  const std::vector<double> origins = {0, 1403.48, 2723.68, 2782.01, 3707.47};
  for (std::size_t i = 0; i < origins.size(); ++i)
    EXPECT_NEAR(water_levels(b, 0, 0, 0, 9000).energy_cm1.at(i), origins[i], 0.4);
  EXPECT_NEAR(water_levels(b, 1, 0, 0, 9000).energy_cm1.at(0), 15.508, 0.01);
  EXPECT_NEAR(water_levels(b, 1, 0, 0, 9000).energy_cm1.at(1), 29.809, 0.01);
  EXPECT_NEAR(water_levels(b, 1, 1, 0, 9000).energy_cm1.at(0), 32.496, 0.01);
}

TEST_F(WaterMolecule, HasItsPartitionSum) {
  const WaterBasis& b = basis(WaterKind::kH2o);
  double sum = 0;
  for (std::size_t j = 0; j <= 14; ++j)
    for (const std::size_t p : {0, 1})
      for (const std::size_t s : {0, 1}) {
        const WaterLevels levels = water_levels(b, j, p, s, 5000);
        for (const double e : levels.energy_cm1)
          sum += levels.nuclear_weight * static_cast<double>(2 * j + 1) *
                 std::exp(-1.4387768775 * e / 296);
      }
  EXPECT_NEAR(sum / 174.58, 1, 1e-3);
}

// From J = 0 all that is not within reach of J = 1 is forbidden: the squared moments add up to the
// mean square of the dipole moment, 1.86 debye and its vibration.
TEST_F(WaterMolecule, KeepsTheDipolesSum) {
  const WaterBasis& b = basis(WaterKind::kH2o);
  const WaterLevels ground = water_levels(b, 0, 0, 0, 17000);
  EXPECT_TRUE(water_moments(b, ground, water_levels(b, 1, 1, 1, 17000)).empty());
  EXPECT_TRUE(water_moments(b, ground, water_levels(b, 1, 0, 0, 17000)).empty());
  EXPECT_TRUE(water_moments(b, ground, water_levels(b, 2, 0, 1, 17000)).empty());
  const WaterLevels above = water_levels(b, 1, 0, 1, 17000);
  const std::vector<double> moment = water_moments(b, ground, above);
  double sum = 0;
  for (std::size_t i = 0; i < above.energy_cm1.size(); ++i)
    sum += moment[i * ground.energy_cm1.size()];
  EXPECT_GT(sum, 1.85 * 1.85);
  EXPECT_LT(sum, 1.90 * 1.90);
  EXPECT_NEAR(std::sqrt(moment[0]), 1.855, 0.02);  // to 1 1 1 without vibration
}

// Groups hold every wavenumber once, in shares of shares, whatever the order.
TEST(NestedTerms, HoldEveryPointOnce) {
  constexpr std::size_t kCount = 200, kFirst = 50;
  std::vector<double> cold(kCount), hot(kFirst + kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    cold[i] = static_cast<double>((37 * i) % kCount);
    hot[kFirst + i] = static_cast<double>((91 * i) % kCount);
  }
  const ColdTerms terms =
      nested_terms(cold.data(), hot, kFirst, kCount, {0.5, 0.3, 0.2}, {0.6, 0.4});
  const std::vector<double> share = {0.3, 0.2, 0.18, 0.12, 0.12, 0.08};
  ASSERT_EQ(terms.point.size(), share.size());
  std::vector<int> seen(kFirst + kCount);
  for (std::size_t t = 0; t < terms.point.size(); ++t) {
    EXPECT_NEAR(terms.weight[t], share[t], 1e-9);
    for (const auto p : terms.point[t]) {
      ++seen[p];
      EXPECT_GE(cold[p - kFirst], t < 2 ? 0 : t < 4 ? 100 : 160);
      EXPECT_LT(cold[p - kFirst], t < 2 ? 100 : t < 4 ? 160 : 200);
    }
  }
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], i < kFirst ? 0 : 1);
  for (const auto low : terms.point[0])
    for (const auto high : terms.point[1]) EXPECT_LT(hot[low], hot[high]);
}

// One wavenumber that absorbs a hundred times as much as all others is a term of its own.
TEST(Terms, HoldALonePoint) {
  const std::vector<double> cold = {1, 1.01, 1.02, 1.03, 100};
  const ColdTerms terms = terms_by_ratio(cold.data(), 0, cold.size(), 4);
  ASSERT_EQ(terms.point.size(), 2U);
  EXPECT_EQ(terms.point[0].size(), 4U);
  EXPECT_EQ(terms.point[1], std::vector<std::uint32_t>{4});
  EXPECT_NEAR(terms.weight[0] + terms.weight[1], 1, 1e-12);
}

// Whatever the shares add up to, the last one takes the rest.
TEST(Terms, LeaveNoPointOut) {
  const std::vector<double> cold = {5, 4, 3, 2, 1, 6, 7, 8, 9, 10};
  const ColdTerms terms = terms_by_share(cold.data(), 0, cold.size(), {0.3, 0.3});
  ASSERT_EQ(terms.point.size(), 2U);
  EXPECT_EQ(terms.point[0], (std::vector<std::uint32_t>{4, 3, 2}));
  EXPECT_EQ(terms.point[1].size(), 7U);
}

}  // namespace
}  // namespace irsig
