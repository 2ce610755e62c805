// Rationale: a step that is quadratic in facets hides in small models and takes all of the time in
// large ones: finding throwers of sunlight once took three quarters of the ship paper's job.
// Expected: from 2000 to 20 000 to 200 000 facets of one hull every count of work grows with an
// exponent of at most 1.1. Source: counts
// (core/base/work_counts.h).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "core/base/work_counts.h"
#include "core/signature/view/unseen.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

WorkCounts work_of(std::uint64_t facets) {
  SceneSpec scene = scene_of(generated("frigate", facets), *builtin_material("hull"), mwir());
  scene.part = {
      {"funnel", {"funnel*"}, 0, true, false},
      {"rest", {"hull*", "deck*", "superstructure*", "mast*", "turret*"}, 0, false, false}};
  work_counts().fill(0);
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 60, 20, 5000, {500, 300});
  ConditionSpec& day = r.condition[0];
  day.sun = true;
  day.sun_direction = normalized(Vec<Body>{0.5, 0.7, -0.5});
  day.sun_cos_zenith = -day.sun_direction.z;
  day.sun_angular_radius_deg = 0.266;
  day.sun_scale = 1;
  r.accuracy = AccuracySpec{};
  r.accuracy.relative_error = 0.01;
  r.accuracy.max_samples_per_replicate = 1024;
  EXPECT_TRUE(simulator->simulate(r).ok());
  // A view that aims at facets which may be bright finds them, and the places where they are seen.
  const Target& target = simulator->target();
  const UndersampledSources unseen(target, simulator->scene().facets, simulator->materials(),
                                   make_aimed_view(target, r.viewpoint).frame);
  const SunDirection sun{day.sun_direction, 0.00465};
  BrightFacets bright;
  bright.past_others = true;
  auto& group = bright.group.emplace_back();
  for (const double least_m2_per_sr : {1e-6, 1e-2, 1.0, 100.0})
    for (const UndersampledSources::Facet& f : unseen.facets(&sun, least_m2_per_sr))
      if (least_m2_per_sr == 1e-6 && f.later > 0 && group.size() < 100) group.push_back(f.facet);
  const AimedView aimed = make_aimed_view(target, r.viewpoint, bright);
  EXPECT_EQ(unseen.by_stratum(aimed, std::array{sun}).size(), aimed.stratum.size());
  return work_counts();
}

TEST(Scaling, NoStepIsQuadraticInFacets) {
  constexpr std::array<std::uint64_t, 3> kFacets = {2'000, 20'000, 200'000};
  std::array<WorkCounts, 3> work{};
  for (std::size_t i = 0; i < kFacets.size(); ++i) work[i] = work_of(kFacets[i]);
  for (std::size_t w = 0; w < kWorkNames.size(); ++w) {
    std::printf("%-16s", kWorkNames[w]);
    for (const WorkCounts& of : work)
      std::printf(" %12llu", static_cast<unsigned long long>(of[w]));
    std::printf("\n");
    // Each facet tries at most 64 throwers, four times.
    if (w == static_cast<std::size_t>(Work::kThrowersTried)) {
      EXPECT_LT(work.back()[w], 4 * 64 * kFacets.back());
      continue;
    }
    for (std::size_t i = 1; i < work.size(); ++i) {
      if (work[i - 1][w] == 0) continue;
      const double ratio = static_cast<double>(work[i][w]) / static_cast<double>(work[i - 1][w]),
                   facets = static_cast<double>(kFacets[i]) / static_cast<double>(kFacets[i - 1]);
      // Planes that touch the target are looked for in a tree: n log^2 n.
      const double most = w == static_cast<std::size_t>(Work::kPlacesTried) ? 1.3 : 1.1;
      EXPECT_LT(std::log(ratio) / std::log(facets), most)
          << kWorkNames[w] << " from " << kFacets[i - 1] << " to " << kFacets[i] << " facets";
    }
  }
}

}  // namespace
}  // namespace irsig
