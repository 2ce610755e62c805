// Rationale: a profile's standard errors hold where the footprint's rim is cut by an edge that few
// samples, or none, fall beyond: their scatter is then 0. Expected: a black plate's radiance times
// the share of the footprint that it covers, within five stated errors, and an rms of 0.15 to 1.3 of
// the points that an edge cuts. Source: Planck's integral and the areas of rectangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "core/signature/profile.h"
#include "core/spectral/planck.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

Mesh plate(double half_width_m, double half_height_m) {
  Mesh mesh;
  mesh.vertex = {{0, -half_width_m, -half_height_m},
                 {0, half_width_m, -half_height_m},
                 {0, half_width_m, half_height_m},
                 {0, -half_width_m, half_height_m}};
  mesh.triangle = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_group = {0, 0};
  mesh.group = {"plate"};
  return mesh;
}

double covered(double at, double width, double half) {
  return std::max(0.0, std::min(at + 0.5 * width, half) - std::max(at - 0.5 * width, -half)) /
         width;
}

TEST(ProfileEdge, NoErrorIsZeroAndNoneLies) {
  const char* asked = std::getenv("IRSIG_PROFILE_PLATES");
  const int plates = asked != nullptr ? std::atoi(asked) : 20;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  double squares = 0, worst = 0;
  int cut = 0;
  for (int n = 0; n < plates; ++n) {
    const double half_y = 0.5 + 2 * uniform(random), half_z = 0.5 + 2 * uniform(random),
                 kelvin = 280 + 200 * uniform(random), width = 0.05 + 0.1 * uniform(random);
    SceneSpec scene = scene_of(plate(half_y, half_z), grey(1), lwir());
    scene.part.front().two_sided = true;
    const auto simulator = simulator_of(scene);
    ViewRequest view = request(*simulator, 0, 0, 1e4, {kelvin});
    view.seed = static_cast<std::uint64_t>(n + 1);
    ProfileSpec profile;
    const double z = half_z * (2 * uniform(random) - 1);
    for (int k = 0; k < 41; ++k) profile.point.push_back({0, half_y * (k - 20) / 20.0 * 1.03, z});
    profile.width_m = profile.height_m = width;
    profile.reflections = {0};
    profile.samples = 500;
    const auto result = simulate_profile(simulator->scene(), view, profile);
    ASSERT_TRUE(result.ok()) << result.status();
    const double full = planck_band_radiance_w_m2_sr(8, 12, kelvin);
    for (std::size_t k = 0; k < profile.point.size(); ++k) {
      const double share = covered(profile.point[k].y, width, half_y) * covered(z, width, half_z);
      const Estimate& stated = result->row[k].radiance_w_m2_sr;
      EXPECT_GT(stated.stderr_, 0);
      const double deviation = (stated.value - share * full) / stated.stderr_;
      EXPECT_LT(std::abs(deviation), 5) << "plate " << n << " point " << k << ": " << stated.value
                                        << " +- " << stated.stderr_ << ", is " << share * full;
      worst = std::max(worst, std::abs(deviation));
      if (share == 0 || share == 1) continue;
      squares += deviation * deviation;
      ++cut;
    }
  }
  const double rms = std::sqrt(squares / cut);
  std::printf("%d plates, %d points at edges: rms z %.2f, worst %.2f\n", plates, cut, rms, worst);
  EXPECT_GT(rms, 0.15);
  EXPECT_LT(rms, 1.3);
}

}  // namespace
}  // namespace irsig
