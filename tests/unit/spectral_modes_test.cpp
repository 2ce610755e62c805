// Errors of sums over wavelengths, from a few stored spectra.
//
// Expected: the standard error of the sums of the replicates, computed from these sums alone.

#include "core/accuracy/spectral_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/accuracy/replicates.h"

namespace irsig {
namespace {

constexpr std::size_t kReplicates = 32;

// Mixes so many random spectra at random, as paths over few sources do; `noise` is of each
// wavelength alone.
SpectralSet mixed(std::size_t bins, std::size_t rank, double noise, double scale, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  SpectralSet shape(rank, std::vector<double>(bins));
  for (std::size_t s = 0; s < rank; ++s)
    for (std::size_t i = 0; i < bins; ++i)
      // Over four orders of magnitude, as in the short waves of a thermal spectrum.
      shape[s][i] = scale * std::pow(10, 4.0 * static_cast<double>(i) / static_cast<double>(bins)) *
                    std::sin(0.3 * static_cast<double>((s + 1) * i) + static_cast<double>(s));
  SpectralSet out(kReplicates, std::vector<double>(bins, 0.0));
  for (auto& replicate : out) {
    for (std::size_t s = 0; s < rank; ++s) {
      const double amount = 10 + normal(random);
      for (std::size_t i = 0; i < bins; ++i) replicate[i] += amount * shape[s][i];
    }
    for (double& value : replicate) value += noise * scale * normal(random);
  }
  return out;
}

// Returns the variance of the sum itself, over replicates.
double direct(const SpectralSet& replicate, const std::vector<double>& weight) {
  ReplicateStatistics s(1);
  for (const auto& spectrum : replicate) {
    double sum = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) sum += weight[i] * spectrum[i];
    s.add(std::vector{sum});
  }
  return s.estimate(0).stderr_;
}

std::vector<double> stderrs(const SpectralSet& replicate) {
  ReplicateStatistics s(replicate.front().size());
  for (const auto& spectrum : replicate) s.add(spectrum);
  std::vector<double> out;
  for (std::size_t i = 0; i < replicate.front().size(); ++i) out.push_back(s.estimate(i).stderr_);
  return out;
}

SumErrors stored(const SpectralSet& modes, const std::vector<double>& stderr_) {
  const std::string encoded = encoded_modes(modes, stderr_);
  EXPECT_EQ(wrong_modes(encoded, stderr_.size()), "");
  const std::vector<float> floats(stderr_.begin(), stderr_.end());
  auto out = SumErrors::make(floats, encoded);
  EXPECT_TRUE(out.ok()) << out.status();
  return *out;
}

double all_as_one(const std::vector<double>& weight, const std::vector<double>& stderr_) {
  double out = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) out += std::abs(weight[i]) * stderr_[i];
  return out;
}

// Windows, random responses of one sign, and differences.
std::vector<std::vector<double>> questions(std::size_t bins) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  std::vector<std::vector<double>> out;
  for (int n = 0; n < 60; ++n) {
    auto& weight = out.emplace_back(bins, 0.0);
    const auto first = static_cast<std::size_t>(uniform(random) * static_cast<double>(bins - 1));
    const auto last =
        first + 1 +
        static_cast<std::size_t>(uniform(random) * static_cast<double>(bins - 1 - first));
    for (std::size_t i = first; i <= last && i < bins; ++i)
      weight[i] = n % 3 == 0 ? 0.05 : n % 3 == 1 ? uniform(random) : uniform(random) - 0.5;
  }
  return out;
}

void expect_errors_of_sums(const SpectralSet& replicate, double slack) {
  const std::size_t bins = replicate.front().size();
  const std::vector<double> error = stderrs(replicate);
  const SpectralSet modes = leading_modes(deviations(replicate), stored_modes(bins));
  const SumErrors sums = stored(modes, error);
  for (const auto& weight : questions(bins)) {
    const double is = sums.of(weight), expected = direct(replicate, weight),
                 largest = all_as_one(weight, error);
    // Never below, but for the rounding of what is stored; not above by more than the rest.
    EXPECT_GE(is, expected - 2e-4 * largest);
    EXPECT_LE(is, expected + slack * largest);
  }
}

// Bins in which replicates differ by their rounding alone, or by what is too small to be squared:
// what two sums make of that need not agree, and what is stored must be sound all the same.
TEST(SpectralModes, OfRoundingTheyHaveNoMoreThanItsVariance) {
  std::mt19937 random(11);
  std::size_t beyond = 0;
  for (int n = 0; n < 200; ++n) {
    SpectralSet replicate(32, std::vector<double>(8));
    for (auto& spectrum : replicate)
      for (std::size_t i = 0; i < spectrum.size(); ++i)
        spectrum[i] = i % 4 == 0   ? 1.1 * (1 + 2.2e-16 * static_cast<double>(random() % 3))
                      : i % 4 == 1 ? 1e-161 * static_cast<double>(random() % 100)
                                   : static_cast<double>(random() % 100);
    const std::vector<double> error = stderrs(replicate);
    const SpectralSet modes = leading_modes(deviations(replicate), 100);
    for (std::size_t i = 0; i < error.size(); ++i) {
      double sum = 0;
      for (const auto& mode : modes) sum += mode[i] * mode[i];
      beyond += sum > 1.0005 * error[i] * error[i] ? 1 : 0;
    }
    EXPECT_EQ(wrong_modes(encoded_modes(modes, error), error.size()), "");
  }
  EXPECT_GT(beyond, 0U);  // else this shows nothing
}

TEST(SpectralModes, SumsHaveTheErrorOfTheReplicatesSums) {
  for (const double scale : {1.0, 1e-25, 1e20})
    expect_errors_of_sums(mixed(81, 5, 0, scale, 1), 0.012);
  // One cause: a mode is enough, and sums of one sign add up without any root.
  const SpectralSet one = mixed(41, 1, 0, 1, 2);
  EXPECT_EQ(leading_modes(deviations(one), 16).size(), 1u);
  expect_errors_of_sums(one, 0.002);
}

// The rest beyond the modes counts as one cause: many causes in many wavelengths, of which 8 kB
// hold few.
TEST(SpectralModes, WhatIsNotStoredIsNeverTakenForIndependent) {
  const SpectralSet many = mixed(600, 20, 0, 1, 3);
  const std::vector<double> error = stderrs(many);
  const std::size_t held = stored_modes(600);
  EXPECT_EQ(held, 2u);
  const SumErrors sums = stored(leading_modes(deviations(many), held), error);
  for (const auto& weight : questions(600)) {
    EXPECT_GE(sums.of(weight), direct(many, weight) * (1 - 1e-4));
    EXPECT_LE(sums.of(weight), all_as_one(weight, error) * (1 + 1e-4));
  }
}

TEST(SpectralModes, WithoutModesAllErrorsAreOne) {
  const std::vector<float> error = {1, 2, 3};
  const auto sums = SumErrors::make(error, "");
  ASSERT_TRUE(sums.ok());
  EXPECT_FALSE(sums->known());
  EXPECT_DOUBLE_EQ(sums->of(std::vector{1.0, -1.0, 2.0}), 9);
}

// The covariances of two independent spectra add up, from the modes of each.
TEST(SpectralModes, ModesOfASumOfIndependentSpectra) {
  const SpectralSet a = mixed(41, 3, 0, 1, 4), b = mixed(41, 2, 0, 0.7, 5);
  SpectralSet both = leading_modes(deviations(a), 16);
  for (const auto& mode : leading_modes(deviations(b), 16)) both.push_back(mode);
  std::vector<double> error;
  const std::vector<double> error_a = stderrs(a), error_b = stderrs(b);
  for (std::size_t i = 0; i < error_a.size(); ++i)
    error.push_back(std::hypot(error_a[i], error_b[i]));
  const SumErrors sums = stored(leading_modes(both, stored_modes(41)), error);
  for (const auto& weight : questions(41)) {
    const double expected = std::hypot(direct(a, weight), direct(b, weight));
    EXPECT_NEAR(sums.of(weight), expected, 0.015 * all_as_one(weight, error));
  }
}

TEST(SpectralModes, NoiseOfEachWavelengthAloneIsKnownUpToTheRest) {
  expect_errors_of_sums(mixed(20, 1, 1e-2, 1, 6), 0.012);
}

TEST(SpectralModes, WavelengthsWithoutErrorAndFewReplicates) {
  SpectralSet replicate = mixed(20, 3, 0, 1, 8);
  for (auto& spectrum : replicate) spectrum[7] = spectrum[19] = 3;
  expect_errors_of_sums(replicate, 0.012);
  EXPECT_TRUE(leading_modes(deviations({replicate[0]}), 5).empty());
  EXPECT_TRUE(leading_modes({}, 5).empty());
  EXPECT_TRUE(leading_modes(deviations(SpectralSet(4, std::vector<double>(9, 2.0))), 5).empty());
}

TEST(SpectralModes, StaysWithinEightKilobytes) {
  for (const std::size_t bins : {1, 2, 41, 81, 682, 1365, 1366, 100000})
    EXPECT_LE(6 * bins * stored_modes(bins), 8192u) << bins;
  EXPECT_EQ(stored_modes(81), 16u);
  EXPECT_EQ(stored_modes(0), 0u);
}

TEST(SpectralModes, WhatIsWrongWithStoredModes) {
  const std::string full("\xff\x7f", 2), half("\x00\x40", 2);  // 32767 and 16384
  EXPECT_EQ(wrong_modes("", 3), "");
  EXPECT_EQ(wrong_modes(full + half, 2), "");
  EXPECT_EQ(wrong_modes(half + half + half + half, 1), "");  // a quarter of the variance each
  EXPECT_EQ(wrong_modes(full + half, 3), "has 4 bytes, expected a multiple of 6");
  EXPECT_EQ(wrong_modes(full, 0), "has 2 bytes, expected a multiple of 0");
  EXPECT_NE(wrong_modes(full + half, 1).find("times the variance of bin 0"), std::string::npos);
  EXPECT_NE(wrong_modes(half + full + half + half, 2).find("times the variance of bin 1"),
            std::string::npos);
  EXPECT_EQ(wrong_modes(std::string(3 * 2 * 1000, '\0'), 1000), "has 3 modes, expected at most 1");
  const std::vector<float> error = {1, 1};
  EXPECT_FALSE(SumErrors::make(error, full).ok());
}

}  // namespace
}  // namespace irsig
