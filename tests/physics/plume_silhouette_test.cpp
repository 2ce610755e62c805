// Rationale: rays are aimed at the gas's bounds, and its projected area is a result.
// Expected: a sphere's area above a threshold of optical depth is a circle's: chord > threshold.
// Source: 2 sqrt(R^2 - b^2) k > threshold.
#include "core/plume/plume_silhouette.h"

#include <gmock/gmock.h>

#include <numbers>

#include "core/plume/generate_plume.h"
#include "tests/physics/plume_fixture.h"

namespace irsig {
namespace {

std::shared_ptr<const PlumeField> silhouette_sphere(double voxel_m) {
  UniformPlume body;
  body.kind = "sphere";
  body.radius_m = 1;
  body.temperature_k = 900;
  body.co2 = 0.1;
  body.voxel_m = voxel_m;
  GeneratedPlume made = *generate_uniform_plume(body);
  made.grids.interpolation = PlumeInterpolation::kConstant;
  made.grids.position_m = {100, -20, -30};
  return *plume_of(made.volume, made.grids);
}

TEST(PlumeSilhouette, AreaAboveAThreshold) {
  const auto field = silhouette_sphere(0.04);
  const double per_m = 3, density = 0.1 * 101325 / (8.31446261815324 * 900);
  const GreyAbsorption grey{{per_m / density, 0, 0, 0}};
  for (const double threshold : {0.5, 3.0, 5.0}) {
    const double chord = threshold / per_m;
    const double area = std::numbers::pi * (1 - chord * chord / 4);
    for (const Vec<Body> to :
         {Vec<Body>{1, 0, 0}, normalized(Vec<Body>{1, -2, 0.5}), Vec<Body>{0, 0, 1}}) {
      const ProjectedGas got = projected_gas(*field, to, grey, threshold, 120);
      // 4 sigma of the lattice, and what voxels of 0.04 m make of the chord.
      EXPECT_NEAR(got.area_m2, area, 4 * got.stderr_m2 + 0.012 * area) << threshold;
      EXPECT_LT(got.stderr_m2, 0.005 * area);
      EXPECT_GT(got.stderr_m2, 0.0005 * area);
    }
  }
  EXPECT_EQ(projected_gas(*field, {1, 0, 0}, grey, 6.3, 60).area_m2, 0);
}

TEST(PlumeSilhouette, NothingOutsideTheWindow) {
  const auto field = silhouette_sphere(0.1);
  const Vec<Body> to = normalized(Vec<Body>{0.3, -0.5, 0.8});
  const GasWindow window = gas_window(*field, to);
  EXPECT_NEAR(length(window.center - Vec<Body>{100, -20, -30}), 0, 0.1);
  EXPECT_NEAR(dot(window.right, window.up), 0, 1e-12);
  EXPECT_NEAR(dot(window.right, to), 0, 1e-12);
  double all = 0, inside = 0;
  for (int i = -30; i < 30; ++i)
    for (int j = -30; j < 30; ++j) {
      const Vec<Body> at =
          window.center + 0.1 * (i + 0.5) * window.right + 0.1 * (j + 0.5) * window.up;
      const bool in = std::abs(0.1 * (i + 0.5)) < window.half_width_m &&
                      std::abs(0.1 * (j + 0.5)) < window.half_height_m;
      for (const GasSegment& s : march(*field, {at - 100.0 * to, to, 0, 200}, {})) {
        all += s.amount[0];
        if (in && s.start_m - 100 >= window.front_m && s.end_m - 100 <= window.back_m)
          inside += s.amount[0];
      }
    }
  EXPECT_GT(all, 0);
  EXPECT_EQ(inside, all);
}

}  // namespace
}  // namespace irsig
