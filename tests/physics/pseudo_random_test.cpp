// Rationale: the same estimator with independent random numbers must agree with the closed form as
// with quasi-random ones, and its error must fall as the law of large numbers says; quasi-random
// numbers must beat it. The plain estimator, which traces each wavelength by itself and has neither
// masks nor strata, must agree too.
//
// Expected: |t| within the bound of docs/explanation/methods.md. Slope of the error against the
// samples: -0.5 for pseudo-random numbers (scatter of a fit over 5 points x 4 x 32 replicates:
// 0.015), -0.70 or steeper for quasi-random ones on the bounding rectangle; with the coverage mask,
// whose columns cut the unit square, the error begins smaller and falls more slowly, but faster
// than pseudo-random. A correlation of independent numbers is within 4.5 sigma of 0.
//
// Source: closed form of a disk as in closed_forms_test.cpp, 0.8 B(8-12 um, 400 K) pi r^2
// cos(theta).
#include <cmath>

#include "core/study/view_estimator.h"
#include "core/transport/vector_stages.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;
constexpr double kRange_m = 1e6;
constexpr double kDisk_w_sr = 168.0637459299374;  // at 60 deg
constexpr std::uint64_t kRows = 3;

struct Disk {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
  std::unique_ptr<ViewEstimator> estimator;
  Disk() : simulator(simulator_of(scene_of(generated("disk", 20000), grey(0.8), lwir()))) {
    request = fixture::request(*simulator, 60, 0, kRange_m, {400});
    auto made = ViewEstimator::create(*simulator, request, {0});
    EXPECT_TRUE(made.ok()) << made.status();
    estimator = *std::move(made);
  }
  [[nodiscard]] ViewValue estimate(const EstimatorOptions& knobs, std::uint64_t samples,
                                   std::uint64_t seed) const {
    const ViewRow row{0, 0};
    return estimator->estimate(knobs, {&row, 1}, samples, seed);
  }
};

// Exponent of the standard error between n = 64 and 16384 samples per replicate, by least squares.
double slope(const Disk& disk, const EstimatorOptions& knobs) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::uint64_t samples = 64; samples <= 16384; samples *= 4) {
    double square = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const double e = disk.estimate(knobs, samples, seed).projected_area_m2.front().stderr_;
      square += e * e;
    }
    const double u = std::log(static_cast<double>(samples)), v = 0.5 * std::log(square);
    n += 1;
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

TEST(PseudoRandom, AgreesWithTheClosedForm) {
  const Disk disk;
  EstimatorOptions knobs;
  knobs.max_reflections = 0;
  expect_within_t(disk.estimate(knobs, 4096, 1).intensity_w_sr.front(), kDisk_w_sr, kRows,
                  "quasi-random", 1e-3, 2e-5 * kDisk_w_sr);
  knobs.pseudo_random = true;
  expect_within_t(disk.estimate(knobs, 1u << 16, 1).intensity_w_sr.front(), kDisk_w_sr, kRows,
                  "pseudo-random", 1e-3, 2e-5 * kDisk_w_sr);
}

TEST(PseudoRandom, PlainMonteCarloAgreesWithTheClosedForm) {
  const Disk disk;
  ReplicateStatistics s(1);
  for (std::uint64_t seed = 1; seed <= 32; ++seed) {
    const RowValue v = disk.estimate(plain_monte_carlo(0), 1u << 14, seed).row.front();
    s.add({&v.intensity_w_sr, 1});
    EXPECT_DOUBLE_EQ(v.intensity_w_sr, v.emitted_w_sr);
  }
  expect_within_t(s.estimate(0), kDisk_w_sr, kRows, "plain Monte Carlo", 1e-3, 2e-5 * kDisk_w_sr);
}

TEST(PseudoRandom, ErrorFallsAsTheSquareRootAndOursFaster) {
  const Disk disk;
  EstimatorOptions knobs;
  knobs.max_reflections = 0;
  const double masked = slope(disk, knobs);
  knobs.coverage_mask = knobs.hot_parts = false;
  const double whole = slope(disk, knobs);
  knobs = {.max_reflections = 0, .pseudo_random = true};
  const double pseudo = slope(disk, knobs);
  std::printf("slope: quasi-random %.3f, with masks %.3f, pseudo-random %.3f\n", whole, masked,
              pseudo);
  EXPECT_NEAR(pseudo, -0.5, 0.08);
  EXPECT_LT(whole, -0.70);
  EXPECT_LT(masked, -0.55);
}

// Consecutive indices, as a stratum asks for them, in several seeds.
TEST(PseudoRandom, NumbersAreUniformAndUncorrelated) {
  constexpr std::uint32_t kCount = 1u << 20;
  SampleList list;
  list.resize(kCount);
  list.size = kCount;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const SeedPair pair = seed_pair(seed, 0);
    for (std::uint32_t i = 0; i < kCount; ++i) {
      list.index[i] = i;
      list.seed_x[i] = pair.x;
      list.seed_y[i] = pair.y;
    }
    draw_pairs_random(list);
    // Means and correlations of x - 1/2 and y - 1/2, in sigmas: 1/12 is the variance.
    double x = 0, y = 0, xy = 0, next = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const double a = static_cast<double>(list.x[i]) - 0.5,
                   b = static_cast<double>(list.y[i]) - 0.5;
      x += a;
      y += b;
      xy += a * b;
      if (i > 0) next += a * (static_cast<double>(list.x[i - 1]) - 0.5);
    }
    const double root = std::sqrt(static_cast<double>(kCount));
    EXPECT_LT(std::abs(x) * std::sqrt(12.0) / root, 4.5);
    EXPECT_LT(std::abs(y) * std::sqrt(12.0) / root, 4.5);
    EXPECT_LT(std::abs(xy) * 12 / root, 4.5);
    EXPECT_LT(std::abs(next) * 12 / root, 4.5);
  }
}

}  // namespace
}  // namespace irsig
