// Rationale: rays are aimed in double from the sensor's place, at facets of single precision: from
// far enough away, all corners of the target have the same coordinates.
// Expected: what a disk sends to a sensor does not depend on the range, within its standard error
// (at most 2e-4), for the smallest and the largest targets and ranges of a sweep file
// (jobs/text/number_bounds.cpp, core/scene/import/import_mesh.cpp) and at the largest ratio of
// range to radius that a job may have, 1e9 (runner/job_runner.cpp), where the sensor's place is
// rounded to 1e-7 of the target. At 1e12 2e-4 are missing, at 1e15 2 to 6 %. Source: I = L A
// cos(angle); the disk's polygon has the area of its circle.
#include <numbers>

#include "core/geo/viewpoint.h"
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

// [sr] A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125; positive where the
// facet faces the origin.
double solid_angle_sr(Vec<Body> a, Vec<Body> b, Vec<Body> c) {
  const double la = length(a), lb = length(b), lc = length(c);
  return -2 * std::atan2(dot(a, cross(b, c)),
                         la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

// Rationale: a sensor beside a long hull is nearer than the hull reaches, and part of the hull may
// even be behind the plane through the sensor across the line to the reference point.
// Expected: L range^2 x the solid angle of the faces that face it; inside the hull it is refused.
TEST(NearView, SensorsBesideALongHull) {
  const Mesh box = generated("box", 200, 0, 154, 10, 10);
  const auto simulator = simulator_of(scene_of(box, grey(0.8), lwir()));
  const std::vector<Viewpoint> views = {{90, 0, 50},  {20, 5, 50},   {0, 0, 78.5}, {45, 60, 40},
                                        {90, 90, 13}, {270, 40, 76}, {5, 0, 75},   {90, 2, 6}};
  for (const Viewpoint& v : views) {
    ViewRequest r =
        request(*simulator, v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m, {400});
    const Vec<Body> sensor =
        v.range_m * body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
    double sr = 0;
    for (const auto& t : box.triangle)
      sr += std::max(0.0, solid_angle_sr(box.vertex[t[0]] - sensor, box.vertex[t[1]] - sensor,
                                         box.vertex[t[2]] - sensor));
    const double expected = kRadiance * v.range_m * v.range_m * sr;
    expect_within_t(only_row(*simulator, r).intensity_w_sr, expected, views.size(),
                    "case " + std::to_string(&v - views.data()), 2e-3, 1e-5 * expected);
  }
  for (const Viewpoint& inside :
       {Viewpoint{90, 0, 4}, Viewpoint{0, 0, 70}, Viewpoint{3, 1, 77.1}}) {
    const auto refused = simulator->simulate(request(
        *simulator, inside.aspect_azimuth_deg, inside.aspect_elevation_deg, inside.range_m, {400}));
    EXPECT_EQ(refused.status().code(), absl::StatusCode::kInvalidArgument)
        << inside.aspect_azimuth_deg;
  }
}

}  // namespace
}  // namespace irsig
