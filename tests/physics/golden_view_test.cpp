// Rationale: results are keyed by kPhysicsVersion; a change of the numbers that forgets to raise it
// would let an old
//   database pass for a new one.
// Expected: the intensities below, to 1e-5 of their value: far above what instruction sets and
// libms may change, far below a
//   standard error (about 1e-3), so that any change of sampling or physics shows.
// Source: this program at the physics version named. When the numbers change on purpose, raise
// kPhysicsVersion and
//   replace them by what the test prints.
#include <cstdio>

#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

TEST(GoldenView, NumbersBelongToThePhysicsVersion) {
  SceneSpec scene;
  scene.mesh = generated("frigate", 5000);
  scene.material = {*builtin_material("hull"), {"stack", Lambert{{{2, 0.9}, {13, 0.7}}}}};
  scene.part = {
      {"ship", {"hull", "deck", "superstructure", "funnel", "mast", "turret"}, 0, false, false},
      {"hot", {"*_*"}, 1, false, true}};
  scene.band = {mwir(), lwir()};
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 70, 25, 5000, {300, 400});
  ConditionSpec& c = r.condition[0];
  c.surroundings = {SurroundingsKind::kSea, 260, 0, 290, 0.96, 0};
  c.sun = true;
  c.sun_direction = normalized(Vec<Body>{0.3, 0.5, -0.8});
  c.sun_cos_zenith = 0.8 / std::sqrt(0.98);
  c.sun_angular_radius_deg = 0.266;
  c.sun_scale = 0.6;
  r.accuracy.samples_per_replicate = 1024;
  r.max_reflections = 8;
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  ASSERT_EQ(kPhysicsVersion, 31);
  const double expected[2][7] = {
      // intensity, projected area, then emitted, sun, sky, sea, parts
      {4242.20862, 2383.09205, 3703.60147, 60.762025, 61.5059997, 301.059879, 115.279242},
      {87068.9027, 2383.09205, 74691.2556, 3.22912554, 3157.53008, 6990.23376, 2226.65412},
  };
  for (std::size_t row = 0; row < 2; ++row) {
    const SignatureResult& s = view->row[row];
    double value[7] = {s.intensity_w_sr.value, s.projected_area_m2.value};
    for (std::size_t k = 0; k < kCauses; ++k) value[2 + k] = s.cause_w_sr[k].value;
    std::printf("      {");
    for (const double v : value) std::printf("%.9g, ", v);
    std::printf("},\n");
    for (std::size_t k = 0; k < 7; ++k)
      EXPECT_NEAR(value[k], expected[row][k], 1e-5 * std::abs(value[k]))
          << "row " << row << " value " << k;
  }
}

}  // namespace
}  // namespace irsig
