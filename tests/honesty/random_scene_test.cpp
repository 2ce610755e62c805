#include "verify/search/random_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "runner/job_runner.h"
#include "verify/search/honesty_search.h"

namespace irsig {
namespace {

absl::Status tried(const RandomScene& scene, bool prepared) {
  const auto made = sweep_of(scene);
  if (!made.ok() || !prepared) return made.status();
  return JobRunner::create(made->sweep, made->assets, {}).status();
}

TEST(RandomScene, EveryOneIsASweepThatCanRun) {
  std::set<SceneFamily> families;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const RandomScene scene = random_scene(seed);
    families.insert(scene.family);
    const absl::Status status = tried(scene, seed <= 25);
    EXPECT_TRUE(status.ok()) << "seed " << seed << ": " << status << "\n"
                             << sweep_toml(scene, "m.obj");
  }
  EXPECT_EQ(families.size(), static_cast<std::size_t>(kSceneFamilies));
}

TEST(RandomScene, IsAFunctionOfItsSeed) {
  for (const std::uint64_t seed : {1ULL, 17ULL, 12345ULL}) {
    const RandomScene a = random_scene(seed), b = random_scene(seed);
    EXPECT_EQ(sweep_toml(a, "m.obj"), sweep_toml(b, "m.obj"));
    EXPECT_EQ(model_obj(a), model_obj(b));
    EXPECT_NE(model_obj(a), model_obj(random_scene(seed + 1)));
  }
}

TEST(RandomScene, WhatIsChangedStillRuns) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed)
    for (int k = 0; k < kInvariances; ++k) {
      const RandomScene scene = random_scene(seed);
      const RandomScene other = changed(scene, static_cast<Invariance>(k));
      const absl::Status status = tried(other, false);
      EXPECT_TRUE(status.ok()) << seed << " " << name_of(static_cast<Invariance>(k)) << ": "
                               << status;
      EXPECT_NE(sweep_toml(scene, "m.obj") + model_obj(scene),
                sweep_toml(other, "m.obj") + model_obj(other));
    }
}

TEST(Shrinking, EndsWithTheLeastThatFails) {
  RandomScene scene = random_scene(2);
  scene.body.resize(1);
  while (scene.body.size() < 7) scene.body.push_back(scene.body.front());
  scene.body[4].temperature_k = 1234;
  scene.homogeneous_air = scene.sun = true;
  int trials = 0;
  // Fails while the one body is there.
  const auto fails = [&](const RandomScene& s) {
    ++trials;
    for (const RandomBody& b : s.body)
      if (b.temperature_k == 1234) return true;
    return false;
  };
  const RandomScene least = shrunk(scene, fails, 1000);
  EXPECT_EQ(least.body.size(), 1u);
  EXPECT_EQ(least.body[0].temperature_k, 1234);
  EXPECT_EQ(least.band.size(), 1u);
  EXPECT_FALSE(least.sun);
  EXPECT_FALSE(least.homogeneous_air);
  EXPECT_LT(trials, 100);

  trials = 0;
  (void)shrunk(scene, fails, 3);
  EXPECT_EQ(trials, 3) << "no more trials than allowed";
  // A scene that never fails when it is smaller stays as it is.
  const RandomScene same = shrunk(
      scene, [](const RandomScene&) { return false; }, 1000);
  EXPECT_EQ(same.body.size(), scene.body.size());
  EXPECT_EQ(sweep_toml(same, "m.obj"), sweep_toml(scene, "m.obj"));
}

}  // namespace
}  // namespace irsig
