// Rationale: rays are aimed in double from the sensor's place, at facets of single precision: from
// far enough away, all corners of the target have the same coordinates.
// Expected: what a disk sends to a sensor does not depend on the range, within its standard error
// (at most 2e-4), for the smallest and the largest targets and ranges of a sweep file
// (jobs/number_bounds.cpp, core/scene/import_mesh.cpp) and at the largest ratio of range to radius
// that a job may have, 1e9 (bridge/job_runner.cpp), where the sensor's place is rounded to 1e-7 of
// the target. At 1e12 2e-4 are missing, at 1e15 2 to 6 %.
// Source: I = L A cos(angle); the disk's polygon has the area of its circle.
#include <numbers>

#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;
constexpr double kRadiance = 106.9927036771598;  // 0.8 B(8-12 um, 400 K): closed_forms_test.cpp

struct FarCase {
  double radius_m, range_m;
};

TEST(FarView, IntensityIsRightAtTheLimitsOfRangeAndSize) {
  const std::vector<FarCase> cases = {
      {1e-6, 1e-3}, {1e-6, 1e3},             // of model files
      {1e-3, 1},    {1e-3, 1e6},             // of generated models
      {1, 1e3},     {1, 1e9},                // as far away as a sweep may ask for
      {1e5, 1e8},   {1e5, 1e9},  {5e5, 1e9}  // the largest
  };
  const auto rows = static_cast<std::uint64_t>(2 * cases.size());
  for (const FarCase& far : cases) {
    const auto [radius_m, range_m] = far;
    const auto simulator =
        simulator_of(scene_of(generated("disk", 2000, radius_m), grey(0.8), lwir()));
    for (const double azimuth_deg : {0.0, 37.0}) {
      ViewRequest r = request(*simulator, azimuth_deg, azimuth_deg / 2, range_m, {400});
      const auto row = only_row(*simulator, r);
      const double area_m2 = std::numbers::pi * radius_m * radius_m;
      const double rad = std::numbers::pi / 180;
      const double expected =
          kRadiance * area_m2 * std::cos(azimuth_deg * rad) * std::cos(azimuth_deg / 2 * rad);
      // The nearer half of the tilted disk is brighter by as much as the other half is not.
      const double near = std::pow(radius_m / range_m, 2);
      expect_within_t(row.intensity_w_sr, expected, rows,
                      "case " + std::to_string(&far - cases.data()) + ", azimuth " +
                          std::to_string(azimuth_deg),
                      2e-4, (10 * near + 1e-5) * expected);
    }
  }
}

}  // namespace
}  // namespace irsig
