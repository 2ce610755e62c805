// Rationale: reflections between facets have a closed form in a diffuse isothermal spherical
// cavity, after any number of
//   reflections; this exercises sampling, roulette, offsets and the definition of N (emission after
//   the N-th reflection).
// Expected: radiance through the opening / blackbody radiance = the table, within the t-bound.
// Source: tests/physics/values/spherical_cavity.csv (closed form). The facetted sphere of 200 k
// triangles changes the
//   form factor of the opening by less than 1e-4.
#include <fstream>
#include <numbers>
#include <sstream>

#include "core/spectral/planck.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

// A sphere of radius 1 seen from inside, without the cap of the half angle about +x.
Mesh cavity(double half_angle_deg) {
  Mesh mesh;
  mesh.group = {"wall"};
  const int rings = 400, sectors = 256;
  const double begin = half_angle_deg * std::numbers::pi / 180, end = std::numbers::pi;
  // Chords of a regular polygon lie inside the circle: this radius gives the rings the circle's
  // area.
  const double widen =
      std::sqrt((2 * std::numbers::pi / sectors) / std::sin(2 * std::numbers::pi / sectors));
  const auto vertex = [&](int ring, int sector) {
    const double theta = begin + (end - begin) * ring / rings,
                 phi = 2 * std::numbers::pi * sector / sectors;
    return Vec<Body>{std::cos(theta), widen * std::sin(theta) * std::cos(phi),
                     widen * std::sin(theta) * std::sin(phi)};
  };
  for (int ring = 0; ring <= rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) mesh.vertex.push_back(vertex(ring, sector));
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t sector = 0; sector < sectors; ++sector) {
      const std::uint32_t a = ring * sectors + sector, b = ring * sectors + (sector + 1) % sectors,
                          c = a + sectors, d = b + sectors;
      if (ring > 0 || half_angle_deg > 0) mesh.triangle.push_back({a, b, c});  // facing inwards
      if (ring + 1 < rings) mesh.triangle.push_back({b, d, c});
    }
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
  return mesh;
}

TEST(SphericalCavity, EveryOrderOfReflection) {
  std::ifstream file(IRSIG_TEST_VALUES "/spherical_cavity.csv");
  ASSERT_TRUE(file);
  const double black = planck_band_radiance_w_m2_sr(8, 12, 400);
  std::string line;
  int tested = 0;
  while (std::getline(file, line)) {
    if (line[0] == '#' || line.starts_with("wall")) continue;
    std::istringstream text(line);
    std::vector<double> v;
    for (std::string field; std::getline(text, field, ',');) v.push_back(std::stod(field));
    const double emissivity = v[0], half_angle_deg = v[1];
    // A few wall emissivities and openings: wide, narrow, dark, shiny.
    if (!((emissivity == 0.1 && (half_angle_deg == 10 || half_angle_deg == 60)) ||
          (emissivity == 0.5 && half_angle_deg == 30) ||
          (emissivity == 0.9 && half_angle_deg == 30)))
      continue;
    const auto simulator = simulator_of(scene_of(cavity(half_angle_deg), grey(emissivity), lwir()));
    const struct {
      std::uint32_t reflections;
      double effective;
    } rows[] = {{0, v[3]}, {1, v[4]}, {2, v[5]}, {5, v[6]}, {10, v[7]}, {50, v[8]}};
    for (const auto& row : rows) {
      if (row.reflections == 50 && half_angle_deg < 20)
        continue;  // 1000 orders would be needed for the limit; 50 says nothing new
      ViewRequest r = request(*simulator, 0, 0, 1000, {400});
      r.max_reflections = row.reflections;
      const auto result = only_row(*simulator, r);
      const double radiance = result.intensity_w_sr.value / result.projected_area_m2.value;
      const double sigma =
          std::max(result.intensity_w_sr.stderr_ / result.projected_area_m2.value, 1e-7 * black);
      expect_within_t({radiance, sigma}, black * row.effective, 24,
                      "cavity eps " + std::to_string(emissivity) + " opening " +
                          std::to_string(half_angle_deg) + " N " + std::to_string(row.reflections),
                      6e-3, 1.5e-4 * black * row.effective);
      // The truncation bound covers the light that was cut off.
      EXPECT_LE(black * (v[2] - row.effective) * result.projected_area_m2.value,
                result.truncation_bound_w_sr * 1.02 + 6 * result.intensity_w_sr.stderr_);
      ++tested;
    }
  }
  EXPECT_EQ(tested, 23);
}

}  // namespace
}  // namespace irsig
