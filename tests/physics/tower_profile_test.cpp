// Rationale: what the cavity paper finds on a cooling tower must come out of its description alone:
// a
//   bright interior deep in the throat, a depression where the fan's hub is, a cool deck on either
//   side, cooler ground, and temperatures that rise with the number of reflections.
// Expected: the order of the temperatures, not their values: the paper gives none, nor the tower's
//   dimensions. A black tower of the same kind has no contrast at all.
// Source: Montanaro et al., Proc. SPIE 6565 (2007) 656511, sections 4.1 and 4.2, Figure 8.
// [montanaro2007]
#include "core/signature/profile.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

struct Tower {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
};

Tower tower(double emissivity) {
  SceneSpec scene;
  scene.mesh = generated("cooling_tower", 5000);
  scene.material = {grey(emissivity), grey(0.95)};
  scene.part = {{"tower", {"casing", "deck", "stack*", "plenum", "fill", "hub"}, 0, false, false},
                {"ground", {}, 1, false, false}};
  scene.band = {{"LWIR", 8, 14, 0.5, {}}};
  Tower out{simulator_of(scene), {}};
  out.request = request(*out.simulator, 180, 65, 120, {306, 288});
  out.request.condition.front().surroundings.sky_temperature_k = 270;
  out.request.condition.front().surroundings.lower_radiance_w_m2_sr_um = 8;
  return out;
}

// Temperatures at y, after 0, 2 and 20 reflections.
std::vector<ProfileRow> across(const Tower& tower, const std::vector<Vec<Body>>& points) {
  ProfileSpec profile;
  profile.point = points;
  profile.width_m = profile.height_m = 0.1;
  profile.reflections = {0, 2, 20};
  profile.source_radiance_temperature_stderr_k = 0.1;
  const auto result = simulate_profile(tower.simulator->scene(), tower.request, profile);
  EXPECT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->counts.guarded_backface_hits, 0U);
  return result->row;
}

TEST(TowerProfile, HubDepressionBrightInteriorCoolDeck) {
  const std::vector<ProfileRow> rows = across(
      tower(0.75),
      {{0, 0, 0}, {0, -2.5, 0}, {0, 2.5, 0}, {0, -5.3, 1.44}, {0, 5.3, 1.44}, {0, 12, 11.44}});
  const auto at = [&](std::size_t point, std::size_t n) {
    return rows[3 * point + n].source_radiance_temperature_k.value;
  };
  enum { kHub, kPort, kStarboard, kDeckPort, kDeckStarboard, kGround };
  for (const int inside : {kPort, kStarboard}) {
    EXPECT_GT(at(inside, 2), at(kHub, 2) + 3);
    EXPECT_GT(at(inside, 2), at(kDeckPort, 2) + 3);
    EXPECT_LT(at(inside, 2), 306);
    EXPECT_GT(at(inside, 1), at(inside, 0) + 10);
    EXPECT_GT(at(inside, 2), at(inside, 1) + 0.3);
  }
  EXPECT_NEAR(at(kPort, 2), at(kStarboard, 2), 1);
  EXPECT_NEAR(at(kDeckPort, 2), at(kDeckStarboard, 2), 0.8);
  EXPECT_LT(at(kGround, 2), at(kHub, 2) - 5);
  for (int p = kHub; p < kGround; ++p)
    EXPECT_NEAR(at(static_cast<std::size_t>(p), 0), at(kHub, 0), 1e-3);
}

TEST(TowerProfile, ABlackTowerHasNoContrast) {
  for (const ProfileRow& row : across(tower(1), {{0, 0, 0}, {0, 2.5, 0}, {0, 5.3, 1.44}}))
    EXPECT_NEAR(row.source_radiance_temperature_k.value, 306, 1e-3);
}

}  // namespace
}  // namespace irsig
