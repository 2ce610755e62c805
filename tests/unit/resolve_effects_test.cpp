// [effects] and the floor of [accuracy]: what a sweep file says becomes part of the sweep. What it
// may not say: bad_sweeps/effects*.toml.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "jobs/keys/expand.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

schema::ResolvedSweep sphere(const std::string& more) {
  const auto sweep = resolved_text(R"(time = ["12:00Z"]
[model]
generate = "sphere"
triangles = 100
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
[[part]]
name = "sphere"
material = "paint"
temperature_k = 300
[[season]]
name = "any"
date = 2025-06-21
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.1
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 0, elevation_deg = 0 } ]
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 0
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
)" + more);
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  return sweep.ok() ? *sweep : schema::ResolvedSweep{};
}

std::string key_of(const schema::ResolvedSweep& sweep) {
  return expand_jobs(sweep, 1).front().job_key();
}

TEST(ResolveEffects, AreAutomaticUnlessTheFileSaysOtherwise) {
  const schema::ResolvedSweep plain = sphere("");
  EXPECT_EQ(plain.sweep().effects().mode(), "auto");
  EXPECT_THAT(plain.sweep().effects().only(), IsEmpty());
  EXPECT_EQ(key_of(sphere("[effects]\nmode = \"auto\"\n")), key_of(plain));
  const schema::ResolvedSweep all = sphere("[effects]\nmode = \"all\"\n");
  EXPECT_EQ(all.sweep().effects().mode(), "all");
  EXPECT_NE(key_of(all), key_of(plain));
  EXPECT_NE(canonical_encoding(all), canonical_encoding(plain));
}

TEST(ResolveEffects, TheSameListIsTheSameSweep) {
  const schema::ResolvedSweep sweep =
      sphere("[effects]\nmode = \"only\"\nonly = [\"sky_reflected\", \"direct_sun\"]\n");
  EXPECT_EQ(sweep.sweep().effects().mode(), "only");
  EXPECT_THAT(sweep.sweep().effects().only(), ElementsAre("direct_sun", "sky_reflected"));
  EXPECT_EQ(key_of(sphere("[effects]\nmode = \"only\"\nonly = [\"direct_sun\", "
                          "\"sky_reflected\"]\n")),
            key_of(sweep));
  const schema::ResolvedSweep none = sphere("[effects]\nmode = \"only\"\nonly = []\n");
  EXPECT_THAT(none.sweep().effects().only(), IsEmpty());
  EXPECT_NE(key_of(none), key_of(sweep));
  EXPECT_NE(key_of(none), key_of(sphere("[effects]\nmode = \"all\"\n")));
}

TEST(ResolveEffects, ARelativeErrorHasAFloor) {
  const auto floor = [](const std::string& accuracy) {
    return sphere("[accuracy]\n" + accuracy).sweep().accuracy();
  };
  EXPECT_EQ(floor("").absolute_error_k(), 0.05);
  EXPECT_EQ(floor("relative_error = 0.001\n").absolute_error_k(), 0.05);
  EXPECT_EQ(floor("absolute_error_k = 0.2\n").absolute_error_k(), 0.2);
  EXPECT_EQ(floor("relative_error = 0.001\nabsolute_error_k = 0\n").absolute_error_k(), 0);
  EXPECT_TRUE(floor("absolute_error_k = 0\n").has_absolute_error_k());
  for (const char* other :
       {"target_paths = 1e6\n", "samples_per_replicate = 64\n", "time_budget_s = 9\n"})
    EXPECT_FALSE(floor(other).has_absolute_error_k()) << other;
  EXPECT_NE(key_of(sphere("[accuracy]\nabsolute_error_k = 0\n")), key_of(sphere("")));
}

}  // namespace
}  // namespace irsig
