// Rationale: where a target fills the rectangle that rays are aimed at, every ray meets it: the
// replicates agree and the standard error is 0. The value must then be exact, or nothing in the
// result tells that it is wrong.
// Expected: range^2 x solid angle of a rectangle seen along its axis, within the standard error and
// the rounding of rays (float: 5e-8 of the target's size, 1e-6 of its area at most).
// Source: closed form: the solid angle of a rectangle on its axis, 4 asin(ab / sqrt((1 + a^2)(1 +
// b^2))).
#include <array>
#include <cmath>
#include <string>

#include "core/spectral/planck.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kRangeM = 1e4;

// A rectangle across the x axis, facing a sensor ahead.
Mesh rectangle(double width_m, double height_m, Vec<Body> centre) {
  Mesh mesh;
  const double y = width_m / 2, z = height_m / 2;
  for (const auto& [dy, dz] : {std::array{-y, -z}, {y, -z}, {y, z}, {-y, z}})
    mesh.vertex.push_back(centre + Vec<Body>{0, dy, dz});
  mesh.triangle = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_group = {0, 0};
  mesh.group = {"plate"};
  return mesh;
}

double seen_area_m2(double width_m, double height_m) {
  const double a = width_m / 2 / kRangeM, b = height_m / 2 / kRangeM;
  return 4 * kRangeM * kRangeM * std::asin(a * b / std::sqrt((1 + a * a) * (1 + b * b)));
}

void expect_area(const Estimate& area, double expected_m2, double rounding,
                 const std::string& what) {
  const double bound = student_t_bound(31, 200) * area.stderr_ + rounding * expected_m2;
  EXPECT_LE(std::abs(area.value - expected_m2), bound)
      << what << ": relative " << area.value / expected_m2 - 1 << " +- "
      << area.stderr_ / expected_m2;
}

TEST(FullMask, APlateThatFillsItIsExact) {
  double worst = 0;
  for (const auto& [width_m, height_m] :
       {std::array{1.0, 1.0}, {2.0, 1.0}, {0.1, 1.0}, {37.0, 1.3}, {1e-3, 7e-4}, {100.0, 1.0}}) {
    SceneSpec scene = scene_of(rectangle(width_m, height_m, {}), grey(0.5), lwir());
    scene.part[0].two_sided = true;
    const auto simulator = simulator_of(scene);
    for (const std::uint64_t samples : {16u, 256u, 4096u})
      for (const std::uint64_t seed : {1u, 2u, 3u}) {
        ViewRequest r = request(*simulator, 0, 0, kRangeM, {300});
        r.accuracy.samples_per_replicate = samples;
        r.seed = seed;
        const Estimate area = only_row(*simulator, r).projected_area_m2;
        const double expected = seen_area_m2(width_m, height_m);
        // The short side's share of the rounding.
        const double longer = std::max(width_m, height_m) / std::min(width_m, height_m);
        expect_area(area, expected, 4e-7 * std::max(1.0, longer / 4),
                    std::to_string(width_m) + " x " + std::to_string(height_m) + " m, " +
                        std::to_string(samples) + " samples, seed " + std::to_string(seed));
        if (area.stderr_ == 0) worst = std::max(worst, std::abs(area.value / expected - 1));
      }
  }
  std::printf("largest error where the standard error is 0: %.2g\n", worst);
}

// A hot part has a mask of its own rectangle, which may lie far off the axis.
TEST(FullMask, SoIsAHotPartBesideTheAxis) {
  for (const double side_m : {0.5, 0.05}) {
    SceneSpec scene = scene_of(
        joined(rectangle(2, 1, {}), rectangle(side_m, side_m, {0, 1 + side_m / 2, 0.2}), "hot_"),
        grey(0.5), lwir());
    scene.part = {{"plate", {"plate"}, 0, true, false}, {"spot", {"hot_*"}, 0, true, true}};
    const auto simulator = simulator_of(scene);
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      // The plate at 0 K: all that is seen is the spot.
      ViewRequest r = request(*simulator, 0, 0, kRangeM, {0, 300});
      r.accuracy.samples_per_replicate = 512;
      r.seed = seed;
      const Estimate e = only_row(*simulator, r).intensity_w_sr;
      const double radiance = 0.5 * planck_band_radiance_w_m2_sr(8, 12, 300);
      const Estimate area{e.value / radiance, e.stderr_ / radiance};
      expect_area(area, seen_area_m2(side_m, side_m), 4e-7 * 3 / side_m,
                  "spot of " + std::to_string(side_m) + " m");
    }
  }
}

// A plate turned by a ten-thousandth fills its mask but for a rim of 2e-4, which most runs of 2048
// rays do not meet: they agree with each other, and are wrong by as much.
TEST(FullMask, ARimThatNoRayMeetsIsInTheNumericalError) {
  constexpr double kTurn = 1e-4;
  Mesh plate = rectangle(2, 2, {});
  for (Vec<Body>& v : plate.vertex) v = {v.x, v.y - kTurn * v.z, v.z + kTurn * v.y};
  SceneSpec scene = scene_of(plate, grey(1), lwir());
  const auto simulator = simulator_of(scene);
  const double expected =
      seen_area_m2(2, 2) * (1 + kTurn * kTurn) * planck_band_radiance_w_m2_sr(8, 12, 300);
  int blind = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ViewRequest r = request(*simulator, 0, 0, kRangeM, {300});
    r.accuracy.samples_per_replicate = 64;
    r.seed = seed;
    const SignatureResult row = only_row(*simulator, r);
    const double error = std::abs(row.intensity_w_sr.value - expected);
    EXPECT_LE(error, 3 * row.numerical_error_w_sr) << seed;
    blind += error > 10 * row.intensity_w_sr.stderr_;
  }
  EXPECT_GT(blind, 4) << "or this test would see nothing";
}

}  // namespace
}  // namespace irsig
