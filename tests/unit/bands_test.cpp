// Margins of windows. Rationale: a designer buys a filter by them. Expected: the scatter that drawn
// errors leave of a merit is that of the closed form, for each kind of error by itself, in the
// whole band and in half of it, of one target and of two. Source: a contrast of 1 W/(sr um) from 3
// to 5 um at 1 km, seen with a noise of 1e-6 W/m2, has a signal-to-noise ratio of the window's
// width.
#include "view/bands/bands.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace irsig {
namespace {

constexpr std::size_t kSearchedBins = 21;
constexpr double kWithin = 0.16;  // of a scatter of 400 draws: 4 sigma

TargetContrast contrast(double level) {
  return {std::vector<double>(kSearchedBins, level),
          {},
          std::vector<double>(kSearchedBins, 0.0),
          0,
          0,
          0};
}

BandPopulation population(TargetContrast target, std::optional<TargetContrast> against = {}) {
  BandPopulation out;
  for (std::size_t k = 0; k < kSearchedBins; ++k)
    out.lambda_um.push_back(3 + 2.0 * static_cast<double>(k) / (kSearchedBins - 1));
  out.row.push_back({1, 0, 0, "s", "t", 0, 0, 1000, std::move(target), std::move(against), {}});
  return out;
}

struct Margins {
  CandidateMerit whole, half;
};
Margins margins(BandPopulation of) {
  const auto search = BandSearch::make(std::move(of), {{}, ConstantNoise{1e-6}});
  EXPECT_TRUE(search.ok()) << search.status();
  const std::size_t last = search->edges_um().size() - 1;
  // Half of it ends in the middle of a bin: up to the limit below.
  std::size_t middle = 0;
  while (search->edges_um()[middle + 1] <= 4) ++middle;
  const Candidate both[] = {search->candidate({}, {0, last}), search->candidate({}, {0, middle})};
  EXPECT_NEAR(both[1].merit, search->edges_um()[middle] - 3, 1e-12);
  EXPECT_NEAR(search->edges_um()[middle], 3.95, 1e-9);
  const WindowChoice choice = search->compare({}, both);
  return {choice.candidate[0], choice.candidate[1]};
}
// Integrals over the window from 3 to 3.95 um, of 1 and of a slope that is -1 at 3 and 1 at 5 um.
constexpr double kShape = 0.95, kSlope = 0.95 * 0.95 / 2 - 0.95;

void expect_near(double found, double expected) {
  EXPECT_NEAR(found / expected, 1, kWithin) << found << " for " << expected;
}

TEST(BandMargins, OfModesAndOfWhatTheyLeaveOver) {
  TargetContrast t = contrast(1);
  t.modes = {std::vector<double>(kSearchedBins, 0.01)};
  Margins m = margins(population(t));
  expect_near(m.whole.samples_stderr, 0.02);
  expect_near(m.half.samples_stderr, 0.01 * kShape);
  EXPECT_DOUBLE_EQ(m.whole.total_error, m.whole.samples_stderr);
  t.modes.clear();
  t.rest = std::vector<double>(kSearchedBins, 0.03);
  m = margins(population(t));
  expect_near(m.whole.samples_stderr, 0.06);
  expect_near(m.half.samples_stderr, 0.03 * kShape);
}

TEST(BandMargins, OfBoundsUnseenLightAndModels) {
  TargetContrast t = contrast(1);
  t.bias_bound_w_sr = 0.1;
  Margins m = margins(population(t));
  EXPECT_EQ(m.whole.samples_stderr, 0);
  // Uniform within the bound, half of the variance level, half slope; of the whole band no slope.
  expect_near(m.whole.numerical_error, 0.1 * std::sqrt(0.5 / 3));
  expect_near(m.half.numerical_error,
              0.1 / 2 * std::sqrt(0.5 * (kShape * kShape / 3 + kSlope * kSlope)));
  EXPECT_DOUBLE_EQ(m.half.total_error, m.half.numerical_error);
  t.bias_bound_w_sr = 0;
  t.undersampling_stderr_w_sr = 0.1;
  m = margins(population(t));
  expect_near(m.half.numerical_error, 0.1 / 2 * kShape);
  t.undersampling_stderr_w_sr = 0;
  t.model_error_w_sr = 0.1;
  m = margins(population(t));
  EXPECT_EQ(m.half.numerical_error, 0);
  expect_near(m.whole.total_error, 0.1 * std::sqrt(0.5));
  expect_near(m.half.total_error,
              0.1 / 2 * std::sqrt(0.5 * (kShape * kShape + 3 * kSlope * kSlope)));
}

// Samples and models of two targets are independent; their bounds err in opposite ways.
TEST(BandMargins, OfTwoTargets) {
  TargetContrast one = contrast(3), other = contrast(2);
  one.modes = other.modes = {std::vector<double>(kSearchedBins, 0.01)};
  expect_near(margins(population(one, other)).whole.samples_stderr, std::sqrt(2.0) * 0.02);
  one.modes = other.modes = {};
  one.bias_bound_w_sr = other.bias_bound_w_sr = 0.1;
  expect_near(margins(population(one, other)).whole.numerical_error, 0.2 * std::sqrt(0.5 / 3));
  one.bias_bound_w_sr = other.bias_bound_w_sr = 0;
  one.model_error_w_sr = other.model_error_w_sr = 0.1;
  expect_near(margins(population(one, other)).whole.total_error, 0.1);
}

// |S| of a contrast that is nothing is as large as its error: that is said, and is in the error.
TEST(BandMargins, OfAContrastThatIsNothing) {
  const auto whole = [](double level) {
    TargetContrast t = contrast(level);
    t.modes = {std::vector<double>(kSearchedBins, 0.01)};
    const auto search = BandSearch::make(population(t), {{}, ConstantNoise{1e-6}});
    EXPECT_TRUE(search.ok());
    const Candidate all[] = {search->candidate({}, {0, search->edges_um().size() - 1})};
    return search->compare({}, all).candidate.front();
  };
  const CandidateMerit nothing = whole(0.0001);
  // The mean of |x| is 0.8 sigma.
  expect_near(nothing.errors_alone, 0.02 * std::sqrt(2 / std::numbers::pi));
  EXPECT_GT(nothing.errors_alone, nothing.of.merit);
  // |x| scatters by 0.6 sigma about 0.8 sigma, which errors add.
  expect_near(nothing.numerical_error, 0.02);
  // To a contrast that is clear they add nothing.
  const CandidateMerit clear = whole(1);
  expect_near(clear.numerical_error, 0.02);
  EXPECT_LT(clear.errors_alone, 0.02 * clear.of.merit);
  EXPECT_FALSE(nothing.known);
  EXPECT_TRUE(clear.known);
}

// A range grows only as the root of the contrast, and a share no further than to one.
TEST(BandMargins, OfAContrastThatIsNothingInOtherMerits) {
  TargetContrast t = contrast(0.05);
  t.modes = {std::vector<double>(kSearchedBins, 0.01)};  // a fifth
  BandPopulation of = population(t);
  of.row.push_back(of.row.front());
  for (BandCase& row : of.row) row.weight = 0.5;
  of.row.back().range_m = 4000;
  const auto search = BandSearch::make(of, {{}, ConstantNoise{1e-6}});
  ASSERT_TRUE(search.ok());
  const auto whole = [&](const MeritOf& merit) {
    const Candidate all[] = {search->candidate(merit, {0, search->edges_um().size() - 1})};
    return search->compare(merit, all).candidate.front();
  };
  // s is 0.1 at 1000 m, one sigma 0.02: of a normal number the mean of the root of |x| is 0.822.
  const CandidateMerit range = whole({Merit::kRange, 10, 0.025});
  EXPECT_NEAR(range.of.merit, 2000, 1e-6);
  EXPECT_NEAR(range.errors_alone, 1000 * std::sqrt(0.8) * 0.822, 0.05 * 735);
  EXPECT_TRUE(range.known);
  EXPECT_FALSE(range.extrapolated);
  // Half of the rows are above 2.5 sigma, which errors alone are rarely.
  EXPECT_TRUE(whole({Merit::kAbove, 10, 0.05}).known);
  // All are above 5e-5 sigma, and so are errors.
  EXPECT_FALSE(whole({Merit::kAbove, 10, 1e-6}).known);
}

// The factor on the samples makes the difference of two windows two sigma, of all that errs.
TEST(BandMargins, SamplesThatWouldTell) {
  const auto second = [](double error, double model) {
    TargetContrast t = contrast(1);
    // Beyond the half there is 0.01 of it, which is what both differ by.
    for (std::size_t k = kSearchedBins / 2; k < kSearchedBins; ++k) t.value[k] = 0.01;
    t.modes = {std::vector<double>(kSearchedBins, error)};
    t.model_error_w_sr = model;
    const auto search = BandSearch::make(population(t), {{}, ConstantNoise{1e-6}});
    EXPECT_TRUE(search.ok());
    const std::size_t last = search->edges_um().size() - 1;
    const Candidate both[] = {search->candidate({}, {0, last}),
                              search->candidate({}, {0, kSearchedBins / 2})};
    const WindowChoice choice = search->compare({}, both);
    EXPECT_EQ(choice.candidate[0].samples_to_tell, 0);
    EXPECT_NEAR(choice.candidate[0].of.merit - choice.candidate[1].of.merit, 0.0105, 3e-4);
    return choice.candidate[1].samples_to_tell;
  };
  EXPECT_EQ(second(0.004, 0), 0);  // told from it at 2.5 sigma
  EXPECT_NEAR(second(0.01, 0) / 4, 1, 0.25);
  EXPECT_NEAR(second(0.02, 0) / 16, 1, 0.25);
  // A model's error of 4 % of both makes nearly nothing of their difference; one as large as all
  // of it leaves nothing that samples could tell.
  EXPECT_NEAR(second(0.01, 0.04) / second(0.01, 0), 1, 0.05);
  EXPECT_TRUE(std::isinf(second(0.01, 1)));
}

// Two that are the same thing share being the best.
TEST(BandMargins, EqualOnesShareBeingTheBest) {
  TargetContrast t = contrast(1);
  t.modes = {std::vector<double>(kSearchedBins, 0.01)};
  const auto search = BandSearch::make(population(t), {{}, ConstantNoise{1e-6}});
  ASSERT_TRUE(search.ok());
  const Candidate same = search->candidate({}, {0, search->edges_um().size() - 1});
  const Candidate both[] = {same, same};
  const WindowChoice choice = search->compare({}, both);
  for (const CandidateMerit& m : choice.candidate) EXPECT_DOUBLE_EQ(m.best, 0.5);
}

// Without a response of its own a detector has that which the band was stored with.
TEST(BandSearchTest, AlikeToABandWhoseResponseEndsInNothing) {
  BandPopulation p = population(contrast(1));
  p.own_response = {{3, 0}, {4, 1}, {5, 0}};
  const auto search = BandSearch::make(p, {{}, ConstantNoise{1e-6}});
  ASSERT_TRUE(search.ok()) << search.status();
  EXPECT_NEAR(search->candidate({}, {0, search->edges_um().size() - 1}).merit, 1, 1e-9);
  EXPECT_FALSE(BandSearch::make(p, {{{3, 1}, {5, 1}}, ConstantNoise{1e-6}}).ok());
  EXPECT_FALSE(BandSearch::make(p, {{}, ConstantNoise{1e-200}}).ok());
}

// Rows of a view share their paths, those of two views do not.
// A contrast whose level has several hills, so that neither the best window nor the best pair is
// the widest one.
BandSearch hilly_search(Pairing pairing, bool flat = false) {
  TargetContrast of = contrast(1);
  for (std::size_t k = 0; k < kSearchedBins && !flat; ++k)
    of.value[k] = std::sin(0.9 * static_cast<double>(k)) + 0.02 * static_cast<double>(k);
  BandPopulation rows = population(std::move(of));
  rows.row.front().background_w_m2_sr_um =
      std::vector<double>(kSearchedBins, pairing == Pairing::kDifference ? 1.0 : 0.0);
  auto search = BandSearch::make(std::move(rows), {{}, ConstantNoise{1e-6}}, pairing);
  EXPECT_TRUE(search.ok()) << search.status();
  return *std::move(search);
}

// The greedy choice by its definition, among the whole list.
std::vector<Candidate> chosen_by_definition(const BandSearch& search, std::size_t most) {
  const auto all = search.search({}, search.step_um(), 1000000, Listed::kAll);
  EXPECT_EQ(all.best.size(), all.judged);
  std::vector<Candidate> out;
  for (const Candidate& c : all.best) {
    bool differs = true;
    for (const Candidate& chosen : out) differs = differs && !search.alike(c, chosen);
    if (differs && out.size() < most) out.push_back(c);
  }
  return out;
}

void expect_same(const std::vector<Candidate>& a, const std::vector<Candidate>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].one, b[i].one) << i;
    EXPECT_EQ(a[i].other, b[i].other) << i;
    EXPECT_EQ(a[i].merit, b[i].merit) << i;
  }
}

TEST(BandSearchTest, WindowsAreAlikeThatShareMoreThanHalf) {
  const BandSearch search = hilly_search(Pairing::kNone);
  const auto alike = [&](Passband a, Passband b) {
    EXPECT_EQ(search.alike({a}, {b}), search.alike({b}, {a}));
    return search.alike({a}, {b});
  };
  // Limits 1 to 20 are those of whole bins.
  EXPECT_TRUE(alike({1, 9}, {1, 9}));
  EXPECT_TRUE(alike({1, 9}, {2, 10}));    // 7 of 9
  EXPECT_TRUE(alike({1, 10}, {3, 12}));   // 7 of 11
  EXPECT_FALSE(alike({1, 10}, {4, 13}));  // 6 of 12
  EXPECT_TRUE(alike({1, 20}, {1, 11}));   // 10 of 19
  EXPECT_FALSE(alike({1, 9}, {1, 5}));    // half
  EXPECT_FALSE(alike({1, 9}, {4, 13}));   // 5 of 12
  EXPECT_FALSE(alike({1, 9}, {9, 17}));   // none
  EXPECT_FALSE(alike({1, 5}, {12, 16}));  // apart
}

// Expected: pairs are alike if both their windows are, whichever of the two is named first.
TEST(BandSearchTest, PairsAreAlikeThatShareBothWindows) {
  const BandSearch search = hilly_search(Pairing::kDifference);
  const auto alike = [&](const Candidate& a, const Candidate& b) {
    EXPECT_EQ(search.alike(a, b), search.alike(b, a));
    return search.alike(a, b);
  };
  const Passband low{1, 5}, high{12, 16}, near_low{1, 6}, near_high{12, 17}, middle{6, 11};
  EXPECT_TRUE(alike({low, high}, {near_low, near_high}));
  EXPECT_TRUE(alike({low, high}, {near_high, near_low}));
  EXPECT_TRUE(alike({high, low}, {near_low, near_high}));
  EXPECT_FALSE(alike({low, high}, {near_low, middle}));
  EXPECT_FALSE(alike({low, high}, {middle, near_high}));
}

TEST(BandSearchTest, ListsWindowsThatDiffer) {
  for (const Pairing pairing : {Pairing::kNone, Pairing::kDifference, Pairing::kMatched}) {
    const BandSearch search = hilly_search(pairing);
    const auto expected = chosen_by_definition(search, 7);
    ASSERT_EQ(expected.size(), 7U);
    const auto found = search.search({}, search.step_um(), 7);
    expect_same(found.best, expected);
    // Fewer pairs than are alike to the best are held: they are judged again.
    expect_same(search.search({}, search.step_um(), 7, Listed::kDifferent, 3).best, expected);
    // A shorter list is the beginning of a longer one, and the first is the best of all.
    const auto shorter = search.search({}, search.step_um(), 3).best;
    expect_same(shorter, {expected.begin(), expected.begin() + 3});
    const auto all = search.search({}, search.step_um(), 7, Listed::kAll).best;
    expect_same({all.front()}, {expected.front()});
    EXPECT_GT(all[1].merit, expected[1].merit);
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), precedes));
  }
}

TEST(BandSearchTest, EqualMeritsAreInTheOrderOfTheirLimits) {
  const BandSearch search = hilly_search(Pairing::kMatched, true);
  const auto all = search.search({}, search.step_um(), 1000000, Listed::kAll).best;
  std::size_t equal = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i].merit != all[i - 1].merit) continue;
    ++equal;
    EXPECT_TRUE(std::pair(all[i - 1].one.first, all[i - 1].one.last) <=
                std::pair(all[i].one.first, all[i].one.last));
  }
  EXPECT_GT(equal, 10U);
  expect_same(search.search({}, search.step_um(), 10).best, chosen_by_definition(search, 10));
}

TEST(BandMargins, RowsOfAViewErrTogether) {
  TargetContrast t = contrast(1);
  t.modes = {std::vector<double>(kSearchedBins, 0.01)};
  for (const bool same_view : {true, false}) {
    BandPopulation p = population(t);
    p.row.push_back(p.row.front());
    p.row[0].weight = p.row[1].weight = 0.5;
    p.row[1].view = same_view ? 0 : 1;
    const double expected = same_view ? 0.02 : 0.02 / std::sqrt(2.0);
    expect_near(margins(p).whole.samples_stderr, expected);
    const auto search = BandSearch::make(std::move(p), {{}, ConstantNoise{1e-6}});
    ASSERT_TRUE(search.ok());
    EXPECT_NEAR(search->mean_stderr({0, search->edges_um().size() - 1}), expected, 1e-12);
  }
}

}  // namespace
}  // namespace irsig
