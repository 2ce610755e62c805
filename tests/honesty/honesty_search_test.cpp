// Rationale: no stored number may be further from the truth than its error explains, in any scene
// that a sweep file can state; and what judges that must be able to say no. Expected: |value -
// truth| within Student's bound (31 degrees of freedom, 0.0005 / values judged) of both errors; not
// more than a twentieth of the scenes undecided. Source: verify/reference/reference_view.h;
// docs/evidence/stability.md.
#include "verify/search/honesty_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "core/accuracy/replicates.h"

namespace irsig {
namespace {

// Known to break their error bar: docs/evidence/stability.md says which cause is behind each. Who
// mends one takes its seeds away.
const std::map<std::uint64_t, const char*> kOpen = {};

TEST(HonestySearch, NoErrorBarIsBroken) {
  SearchOptions options;
  options.threads = 2;
  const SearchSummary summary = search(options, nullptr);
  for (const SceneVerdict* failed : summary.failed()) {
    const auto open = kOpen.find(failed->seed);
    if (open != kOpen.end()) {
      std::printf("open (%s): %s\n", open->second, verdict_line(*failed, summary.bound).c_str());
      continue;
    }
    ADD_FAILURE() << verdict_line(*failed, summary.bound) << "\nirsig selftest --search --seeds "
                  << failed->seed << " writes it as a file";
  }
  for (const auto& [seed, cause] : kOpen) {
    bool fails = false;
    for (const SceneVerdict* failed : summary.failed()) fails |= failed->seed == seed;
    if (!fails) std::printf("holds now: seed %d (%s)\n", static_cast<int>(seed), cause);
  }
  EXPECT_LE(20 * summary.undecided(), summary.scene.size());
  EXPECT_TRUE(summary.spread().holds()) << summary.spread().rms;
  std::printf("%s", summary_text(summary).c_str());
}

// Scenes beyond the search's own seeds that broke an error bar before, or are the first to find a
// mutant which seeds 1 to 60 do not (docs/evidence/stability.md): nothing allowed for what no
// sample met (39, 154), light of hot parts that is drawn and aimed at counted twice (220), an Earth
// that hides nothing (212).
TEST(HonestySearch, ScenesThatTellMutantsApartHold) {
  const std::pair<std::uint64_t, SceneFamily> scenes[] = {{39, SceneFamily::kMirrorPair},
                                                          {154, SceneFamily::kSmallMirror},
                                                          {212, SceneFamily::kHorizon},
                                                          {220, SceneFamily::kHole}};
  for (const auto& [seed, family] : scenes) {
    SearchOptions options;
    options.first = options.last = seed;
    options.invariances = 0;
    // The scene is still what it was chosen for.
    EXPECT_EQ(random_scene(seed, options.grammar).family, family) << seed;
    const SearchSummary summary = search(options, nullptr);
    ASSERT_EQ(summary.scene.size(), 1u);
    EXPECT_EQ(summary.undecided(), 0u) << seed;
    for (const SceneVerdict* failed : summary.failed())
      ADD_FAILURE() << verdict_line(*failed, summary.bound);
  }
}

JudgedValue value_of(double value, double error, double truth, double truth_error) {
  JudgedValue out;
  out.value = value;
  out.error = error;
  out.truth = truth;
  out.truth_error = truth_error;
  return out;
}

SearchSummary one_scene(std::vector<JudgedValue> values) {
  SearchSummary out;
  out.bound = 6;
  out.scene.emplace_back().value = std::move(values);
  return out;
}

TEST(HonestyJudge, CountsBothErrors) {
  EXPECT_DOUBLE_EQ(value_of(15, 3, 0, 4).deviation(), 3);
  EXPECT_DOUBLE_EQ(value_of(0, 0, 0, 0).deviation(), 0) << "nothing there, and nothing said";
  EXPECT_TRUE(std::isinf(value_of(1, 0, 0, 0).deviation()));
}

TEST(HonestyJudge, FailsBeyondTheBoundAndOnWhatIsNoNumber) {
  EXPECT_TRUE(one_scene({value_of(5.9, 1, 0, 0)}).failed().empty());
  EXPECT_EQ(one_scene({value_of(-6.1, 1, 0, 0)}).failed().size(), 1u);
  EXPECT_EQ(one_scene({value_of(1, 1, 1.5, 0), value_of(6.1, 1, 0, 0)}).failed().size(), 1u);
  EXPECT_EQ(one_scene({value_of(std::nan(""), 1, 0, 0)}).failed().size(), 1u);
  EXPECT_EQ(one_scene({value_of(1, 0, 0, 0)}).failed().size(), 1u) << "an error of 0 is a claim";
  SearchSummary broken = one_scene({});
  broken.scene[0].status = absl::InternalError("no such job");
  EXPECT_EQ(broken.failed().size(), 1u) << "a scene that cannot be computed";
  EXPECT_THAT(verdict_line(broken.scene[0], 6), testing::HasSubstr("no such job"));
}

TEST(HonestyJudge, ListsWhatIsBeyondFive) {
  const std::string text = summary_text(one_scene({value_of(5.5, 1, 0, 0), value_of(1, 1, 0, 0)}));
  EXPECT_THAT(text, testing::HasSubstr("5.5 errors"));
  EXPECT_THAT(text, testing::HasSubstr("0 failed"));
}

// Standard errors that are half of what they should be break no bound, but scatter too much.
TEST(HonestyJudge, SeesErrorsThatAreTooSmall) {
  SearchSummary fair, halved;
  fair.bound = halved.bound = 6;
  for (int i = 0; i < 20; ++i) {
    // Quantiles of a normal distribution, nearly.
    const double q = (i + 0.5) / 20, t = std::log(q / (1 - q)) / 1.7;
    for (const auto& [summary, error] : {std::pair{&fair, 1.0}, std::pair{&halved, 0.5}}) {
      JudgedValue v = value_of(t, error, 0, 0);
      v.statistical = true;
      summary->scene.emplace_back().value = {v};
    }
  }
  EXPECT_TRUE(fair.spread().holds()) << fair.spread().rms;
  EXPECT_FALSE(halved.spread().holds()) << halved.spread().rms;
  EXPECT_TRUE(halved.failed().empty());
}

// The values judged: the more, the further the tail that a correct program may reach.
TEST(HonestyJudge, BoundGrowsWithWhatIsJudged) {
  SearchOptions few, many;
  few.last = 10;
  many.last = 2000;
  EXPECT_GT(failure_bound(few), 4.5);
  EXPECT_EQ(failure_bound(SearchOptions{}), student_t_bound(31, 270));
  EXPECT_LT(failure_bound(few), failure_bound(many));
  EXPECT_LT(failure_bound(many), 8);
}

// The verdict is the same with any number of threads.
TEST(HonestySearch, DoesNotDependOnThreads) {
  SearchOptions options;
  options.first = 7;
  options.last = 9;
  options.invariances = 1;
  options.most_reference_rays = 20'000;
  const SearchSummary one = search(options, nullptr);
  options.threads = 3;
  const SearchSummary three = search(options, nullptr);
  EXPECT_EQ(summary_text(one), summary_text(three));
}

}  // namespace
}  // namespace irsig
