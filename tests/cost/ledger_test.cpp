// Rationale: nobody notices when a view asks for twice the rays, or evaluates the air twice, while
// all numbers stay right. Expected: for the first viewpoint of each example, at the accuracy that
// it asks for, counts of rays, paths, samples, allocations and of what core/base/work_counts.h
// names stay within 5 % of ledger.csv, in which they change with a reason in the same commit
// (IRSIG_LEDGER=FILE writes the counts of this build). Source: the program itself; counts depend
// neither on the machine's speed nor on its load.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "core/base/work_counts.h"
#include "jobs/keys/expand.h"
#include "planning/load_sweep.h"
#include "runner/job_runner.h"
#include "tests/cost/allocations.h"

namespace irsig {
namespace {

using Counts = std::map<std::string, std::uint64_t>;

Counts counts_of(const std::string& example) {
  auto loaded = load_sweep(std::string(IRSIG_SOURCE_DIR "/jobs/examples/") + example + ".toml", {});
  EXPECT_TRUE(loaded.ok()) << loaded.status();
  if (!loaded.ok()) return {};
  schema::ResolvedSweep& sweep = loaded->resolved;
  while (sweep.viewpoint_size() > 1) sweep.mutable_viewpoint()->RemoveLast();
  sweep.mutable_sweep()->mutable_output()->set_thumbnail_px(0);
  const auto runner = JobRunner::create(sweep, loaded->assets, {});
  EXPECT_TRUE(runner.ok()) << runner.status();
  if (!runner.ok()) return {};
  work_counts().fill(0);
  const auto result = (*runner)->run(expand_jobs(sweep, 1).front());
  EXPECT_TRUE(result.ok()) << result.status();
  if (!result.ok()) return {};
  Counts out = {{"rays", result->rays()},
                {"samples", result->samples()},
                {"target_paths", result->target_paths()}};
  for (std::size_t i = 0; i < kWorkNames.size(); ++i) out[kWorkNames[i]] = work_counts()[i];
  // Allocations are those of a second view: the first one makes shared data, which differ from
  // process to process.
  const Allocations before = allocations();
  EXPECT_TRUE((*runner)->run(expand_jobs(sweep, 1).front()).ok());
  const Allocations after = allocations();
  out["allocations"] = after.count - before.count;
  out["allocated_kb"] = (after.bytes - before.bytes) / 1000;
  return out;
}

std::map<std::string, Counts> ledger() {
  std::map<std::string, Counts> out;
  std::ifstream file(IRSIG_SOURCE_DIR "/tests/cost/ledger.csv");
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words(line);
    std::string example, what, count;
    std::getline(words, example, ',');
    std::getline(words, what, ',');
    std::getline(words, count, ',');
    out[example][what] = std::strtoull(count.c_str(), nullptr, 10);
  }
  return out;
}

class Ledger : public testing::TestWithParam<std::string> {};

TEST_P(Ledger, CountsStayWhatTheyAre) {
  constexpr double kMost = 0.05;
  const Counts counts = counts_of(GetParam());
  ASSERT_FALSE(counts.empty());
  if (const char* file = std::getenv("IRSIG_LEDGER")) {
    std::ofstream out(file, std::ios::app);
    for (const auto& [what, count] : counts)
      out << GetParam() << "," << what << "," << count << "\n";
  }
  Counts known = ledger()[GetParam()];
  EXPECT_EQ(known.size(), counts.size()) << "tests/cost/ledger.csv has other counts";
  for (const auto& [what, count] : counts) {
    if (what.starts_with("alloc") && !counts_allocations()) continue;
    const auto stated = static_cast<double>(known[what]);
    EXPECT_NEAR(static_cast<double>(count), stated, kMost * stated)
        << what << " of " << GetParam()
        << ": if this has a reason, change tests/cost/ledger.csv and say so";
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, Ledger,
                         testing::Values("quickstart", "frigate", "frigate_paper", "frigate_plume",
                                         "drone", "painted_sphere"),
                         [](const auto& name) { return name.param; });

}  // namespace
}  // namespace irsig
