// Rationale: paths carry their spectra at a few nodes only; whatever lies between must follow from
// them. And what is cut off after the last reflection must be covered by its bound.
// Expected: stated with each test. Seeds are fixed.
// Source: the same paths carried at every node; the closed form of a spherical cavity.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/spectral/planck.h"
#include "core/transport/path_tracer.h"
#include "core/transport/spectral_basis.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

// Metal-like and water-like optical constants over 3-12 um, with a strong band at 6.1 um.
MaterialSpec metal() {
  CookTorrance lobe;
  lobe.constants = {{2.9, 4, 13.5}, {4, 4.6, 18.2}, {5, 4.8, 22.9},  {7, 5.9, 31},
                    {8, 6.4, 36.4}, {10, 8, 45},    {12.5, 10.6, 55}};
  lobe.roughness = 0.2;
  return {"metal", lobe};
}
MaterialSpec water() {
  CookTorrance lobe;
  lobe.constants = {{2.9, 1.35, 0.25},   {3, 1.371, 0.272},   {3.2, 1.478, 0.0924},
                    {3.6, 1.385, 0.005}, {4.8, 1.33, 0.015},  {5.6, 1.289, 0.0142},
                    {6, 1.265, 0.107},   {6.1, 1.319, 0.131}, {6.4, 1.339, 0.0449},
                    {8, 1.291, 0.0343},  {10, 1.218, 0.0508}, {11, 1.153, 0.0968},
                    {12.5, 1.123, 0.259}};
  lobe.roughness = 0.15;
  return {"water", lobe};
}

SceneSpec frigate_of_two() {
  SceneSpec scene = scene_of(generated("frigate", 5000), metal(), {"all", 3, 12, 0.1, {}});
  scene.material.push_back(water());
  scene.material.push_back(grey(0.4));
  scene.part = {{"ship", {"hull", "superstructure", "turret"}, 0, false, false},
                {"deck", {"deck", "funnel", "mast"}, 1, false, false},
                {"hot", {"*_*"}, 2, false, true}};
  return scene;
}

TEST(SpectralBasis, ExpandsWhatPathsCarry) {
  const auto simulator = simulator_of(frigate_of_two());
  const SpectralBasis& basis = simulator->basis();
  ASSERT_FALSE(basis.identity());
  EXPECT_LT(4 * basis.columns(), basis.nodes);
  EXPECT_LE(basis.relative_error, 1e-5);
  std::printf("%zu of %zu nodes carried, error %.2g\n", basis.columns(), basis.nodes,
              basis.relative_error);
  // A carried node is its own interpolation.
  for (std::size_t k = 0; k < basis.columns(); ++k)
    for (std::size_t j = 0; j < basis.columns(); ++j)
      EXPECT_NEAR(basis.expand[basis.carried[k] * basis.columns() + j], j == k ? 1 : 0, 1e-9);

  // Trace the directions with all nodes and with the few. Roulette plays with the largest factor of
  // those carried, so that fates differ; without roulette they do not.
  const AimedView view = make_aimed_view(simulator->target(), {60, 20, 5000});
  PathSettings s;
  s.max_reflections = 3;
  s.samples = 512;
  s.seed = 99;
  s.roulette_survival_scale = 1e9;
  const SourceGeometry sunny = lit_by({{normalized(Vec<Body>{0.2, 0.6, -0.7}), 0.005}});
  const PathTracer few(simulator->target(), simulator->carried_materials(), view, sunny, s);
  const PathTracer all(simulator->target(), simulator->materials(), view, sunny, s);
  PathCounts counts[2];
  const auto a = few.trace(counts[0]);
  const auto b = all.trace(counts[1]);
  ASSERT_EQ(counts[0].rays, counts[1].rays);
  double worst = 0;
  std::vector<double> expanded(basis.nodes);
  const std::vector<double> none(basis.nodes, 0.0);
  for (std::size_t r = 0; r < a.size(); ++r)
    for (std::uint32_t f = 0; f < few.firsts(); ++f)
      for (const SourceId id : few.layout().all()) {
        const double *carried = a[r].weight.find(f, id), *whole = b[r].weight.find(f, id);
        basis.to_nodes(carried != nullptr ? carried : none.data(), 0, expanded);
        for (std::size_t k = 0; k < basis.nodes; ++k)
          worst = std::max(worst, std::abs(expanded[k] - (whole != nullptr ? whole[k] : 0)) /
                                      b[r].projected_area_m2);
      }
  std::printf("largest difference / projected area %.2g\n", worst);
  EXPECT_LT(worst, 2e-5);
  EXPECT_GT(worst, 0);

  // fold() is the transpose of to_nodes().
  std::vector<double> values(30), carried(basis.columns(), 0.5);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(static_cast<double>(i));
  carried[1] = -2;
  const std::vector<double> folded = basis.fold(40, values);
  std::vector<double> on_nodes(values.size());
  basis.to_nodes(carried.data(), 40, on_nodes);
  double left = 0, right = 0;
  for (std::size_t i = 0; i < values.size(); ++i) left += values[i] * on_nodes[i];
  for (std::size_t k = 0; k < carried.size(); ++k) right += folded[k] * carried[k];
  EXPECT_NEAR(left, right, 1e-12);
}

// A row's parts, causes and spectrum come from the carried nodes by different ways.
TEST(SpectralBasis, RowsAreConsistent) {
  const auto simulator = simulator_of(frigate_of_two());
  ViewRequest r = request(*simulator, 60, 20, 5000, {300, 310, 400});
  r.condition[0].surroundings = {SurroundingsKind::kSea, 260, 0, 290, 0.96, 0};
  r.max_reflections = 8;
  r.accuracy.samples_per_replicate = 1024;
  r.thumbnail_px = 16;
  const SignatureResult s = only_row(*simulator, r);
  double causes = 0, parts = 0, spectrum = 0;
  for (const Estimate& e : s.cause_w_sr) causes += e.value;
  for (const Estimate& e : s.part_w_sr) parts += e.value;
  for (const double v : s.spectral.value) spectrum += v;
  EXPECT_NEAR(causes, s.intensity_w_sr.value, 1e-9 * causes);
  EXPECT_NEAR(parts, s.intensity_w_sr.value, 1e-9 * causes);
  EXPECT_NEAR(spectrum * 0.1, s.intensity_w_sr.value, 0.02 * causes);
  // Each path's light may be off by the basis's error, and all of them the same way.
  EXPECT_GE(s.spectral_basis_bound_w_sr, simulator->basis().relative_error * causes);
  EXPECT_LT(s.spectral_basis_bound_w_sr, 5e-5 * causes);
  double image = 0;
  for (const float v : s.image_w_m2_sr) image += static_cast<double>(v);
  EXPECT_GT(image, 0);
}

TEST(SpectralBasis, GreyScenesCarryNothing) {
  const auto simulator = simulator_of(scene_of(generated("box", 12), grey(0.4), lwir()));
  EXPECT_TRUE(simulator->basis().identity());
}

// A sphere of radius 1 with an opening of 10 deg about x; of what leaves the wall, kWall meets it
// again.
constexpr int kRings = 200;
const double kWall = (1 + std::cos(std::numbers::pi / 18)) / 2;

Mesh hollow_sphere() {
  Mesh mesh;
  mesh.group = {"wall"};
  const int rings = kRings, sectors = 200;
  const double begin = std::numbers::pi / 18, turn = 2 * std::numbers::pi / sectors;
  const double widen = std::sqrt(turn / std::sin(turn));
  for (int ring = 0; ring <= rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) {
      const double theta = begin + (std::numbers::pi - begin) * ring / rings;
      mesh.vertex.push_back({std::cos(theta), widen * std::sin(theta) * std::cos(turn * sector),
                             widen * std::sin(theta) * std::sin(turn * sector)});
    }
  for (std::uint32_t ring = 0; ring < kRings; ++ring)
    for (std::uint32_t sector = 0; sector < sectors; ++sector) {
      const std::uint32_t a = ring * sectors + sector, b = ring * sectors + (sector + 1) % sectors;
      mesh.triangle.push_back({a, b, a + sectors});
      if (ring + 1 < kRings) mesh.triangle.push_back({b, b + sectors, a + sectors});
    }
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
  return mesh;
}

// A wall of emissivity 1e-3: 0.1165 in the limit, after a hundred reflections and more on average.
// With enough of them the row is right; with too few it says so, and its bound holds what is
// missing.
TEST(Truncation, ReflectanceOf0_999) {
  const auto simulator = simulator_of(scene_of(hollow_sphere(), grey(1e-3), lwir()));
  const double wall = kWall;
  const double limit = 1e-3 / (1 - 0.999 * wall);
  const double black = planck_band_radiance_w_m2_sr(8, 12, 400);
  ViewRequest r = request(*simulator, 0, 0, 1e4, {400});
  r.accuracy.samples_per_replicate = 2048;
  for (const std::uint32_t n : {4u, 16u, 64u, 5000u}) {
    r.max_reflections = n;
    const SignatureResult s = only_row(*simulator, r);
    const double scale = black * s.projected_area_m2.value;
    const double after_n = limit * (1 - std::pow(0.999 * wall, n + 1));
    expect_within_t(s.intensity_w_sr, after_n * scale, 8,
                    "reflectance 0.999, N " + std::to_string(n), 0.05, 2e-3 * after_n * scale);
    const double missing = (limit - after_n) * scale;
    std::printf("   missing %.4g, bound %.4g, rigorous %.4g W/sr\n", missing,
                s.truncation_bound_w_sr, std::pow(0.999 * wall, n) * 0.999 * scale);
    EXPECT_GE(s.truncation_bound_w_sr + 1e-6 * scale, missing);
    if (n == 5000) {
      EXPECT_LT(s.truncation_bound_w_sr, 1e-3 * limit * scale);
    }
    // The series is known to be geometric: the bound is not the seven times of the rigorous one.
    if (n == 16 || n == 64) {
      EXPECT_LT(s.truncation_bound_w_sr, 2 * missing);
    }
  }
}

// Paths that carry spectra: their throughput has the largest spectral factor in it. The closed form
// of what goes on after N reflections is area x reflectance^(N + 1) x wall^N at the wavelength that
// the wall reflects best; reflectances above 1 (a material that creates energy) grow instead of
// falling.
TEST(Truncation, SpectralThroughputIsThatOfTheBrightestWavelength) {
  TabulatedBrdf glowing;
  glowing.lambda_um = {7, 13};
  glowing.theta_i_deg = glowing.theta_r_deg = {0, 90};
  glowing.phi_deg = {0, 180};
  for (const float brdf_per_sr : {0.1f, 0.5f})
    glowing.brdf_per_sr.insert(glowing.brdf_per_sr.end(), 8, brdf_per_sr);
  for (const MaterialSpec& material :
       {MaterialSpec{"paint", Lambert{{{7, 0.9}, {13, 0.4}}}}, MaterialSpec{"glow", glowing}}) {
    const auto simulator =
        simulator_of(scene_of(hollow_sphere(), material, {"all", 8, 12, 0.5, {}}));
    const double reflectance = simulator->carried_materials()[0].dhr_max(0.5f);
    EXPECT_EQ(reflectance > 1, simulator->energy_gain());
    const AimedView view = make_aimed_view(simulator->target(), {0, 0, 1e4});
    PathSettings s;
    s.samples = 1024;
    s.seed = 7;
    s.roulette_survival_scale = 1e9;
    for (const std::uint32_t n : {1u, 3u, 5u}) {
      s.max_reflections = n;
      const PathTracer tracer(simulator->target(), simulator->carried_materials(), view, {}, s);
      ASSERT_TRUE(tracer.spectral());
      PathCounts counts;
      ReplicateStatistics statistics(1);
      for (const PathWeights& w : tracer.trace(counts)) {
        EXPECT_EQ(w.truncated_m2, w.beyond_m2[2]);
        statistics.add(std::vector{w.truncated_m2 / w.projected_area_m2});
      }
      expect_within_t(statistics.estimate(0), std::pow(reflectance, n + 1) * std::pow(kWall, n), 6,
                      material.name + ", N " + std::to_string(n), 0.01,
                      1e-3 * std::pow(reflectance, n + 1));
    }
  }
}

// Half the wall reflects what the other half absorbs: no wavelength keeps the throughput of the
// brightest, and the bound must hold whatever is missing at each.
TEST(Truncation, BoundHoldsAChainOfSpectralMaterials) {
  Mesh mesh = hollow_sphere();
  mesh.group = {"left", "right"};
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i)
    mesh.triangle_group[i] = mesh.vertex[mesh.triangle[i][0]].y < 0 ? 0 : 1;
  SceneSpec scene =
      scene_of(mesh, {"short", Lambert{{{7, 0.1}, {13, 0.7}}}}, {"all", 8, 12, 0.5, {}});
  scene.material.push_back({"long", Lambert{{{7, 0.7}, {13, 0.1}}}});
  scene.part = {{"left", {"left"}, 0, false, false}, {"right", {"right"}, 1, false, false}};
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 0, 0, 1e4, {400, 400});
  r.accuracy.samples_per_replicate = 2048;
  r.max_reflections = 200;
  const SignatureResult all = only_row(*simulator, r);
  for (const std::uint32_t n : {1u, 2u, 4u, 12u}) {
    r.max_reflections = n;
    const SignatureResult s = only_row(*simulator, r);
    const double missing = all.intensity_w_sr.value - s.intensity_w_sr.value;
    const double black = planck_band_radiance_w_m2_sr(8, 12, 400) * s.projected_area_m2.value;
    std::printf("N %2u: missing %.4g, bound %.4g W/sr\n", n, missing, s.truncation_bound_w_sr);
    EXPECT_GE(s.truncation_bound_w_sr, missing);
    // The best reflectance of either material at each vertex: 0.82 at both ends of the nodes.
    EXPECT_LE(s.truncation_bound_w_sr, 1.02 * std::pow(0.82, n + 1) * black);
  }
}

TEST(Truncation, GeometricOnlyWhereItIs) {
  const auto bound = [](std::array<double, 3> beyond, std::uint32_t spacing, Estimate last,
                        double at_most) {
    return truncation_bound(beyond, spacing, last, at_most);
  };
  EXPECT_DOUBLE_EQ(bound({4, 2, 1}, 1, {3, 0.1}, 100), 4.5);    // 1.5 x 3 x (1/2 + 1/4 + ..)
  EXPECT_DOUBLE_EQ(bound({16, 4, 1}, 2, {3, 0.1}, 100), 4.5);   // the same, every second one
  EXPECT_DOUBLE_EQ(bound({4, 2, 1}, 1, {3, 0.1}, 2), 2);        // the rigorous one is smaller
  EXPECT_DOUBLE_EQ(bound({4, 2, 1}, 1, {3, 0.4}, 100), 100);    // last is not known
  EXPECT_DOUBLE_EQ(bound({4, 1, 0.5}, 1, {3, 0.1}, 100), 100);  // a slower tail shows up
  EXPECT_DOUBLE_EQ(bound({1, 1, 1}, 1, {3, 0.1}, 100), 100);
  EXPECT_DOUBLE_EQ(bound({0, 0, 1}, 1, {3, 0.1}, 100), 100);  // no history
  EXPECT_DOUBLE_EQ(bound({4, 2, 1}, 1, {0, 0}, 100), 100);    // nothing seen
}

// A near-mirror that could throw sunlight onto the deck, which too few paths have met: the row says
// how much that could be, and does not say that the target is reached.
TEST(Unseen, ACausticThatWasNotMetIsBounded) {
  Mesh corner;
  corner.group = {"floor", "mirror"};
  corner.vertex = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 1, -1}};
  corner.triangle = {{0, 2, 1}, {0, 3, 2}, {0, 4, 5}, {0, 5, 3}};
  corner.triangle_group = {0, 0, 1, 1};
  SceneSpec scene = scene_of(corner, grey(0.3), mwir());
  CookTorrance lobe;
  lobe.constants = {{0, 1.2, 5.0}};
  lobe.roughness = 1e-3;
  scene.material.push_back({"mirror", lobe});
  scene.part = {{"floor", {"floor"}, 0, true, false}, {"mirror", {"mirror"}, 1, true, false}};
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 20, 30, 1e5, {300, 300});
  ConditionSpec& c = r.condition[0];
  c.surroundings = {SurroundingsKind::kSea, 250, 0, 290, 1, 0};
  c.sun = true;
  c.sun_direction = normalized(Vec<Body>{1, -0.3, -1});
  c.sun_cos_zenith = -c.sun_direction.z;
  c.sun_angular_radius_deg = 0.266;
  c.sun_scale = 1;
  r.max_reflections = 8;
  r.accuracy.samples_per_replicate = 0;
  r.accuracy.relative_error = 0.02;
  const SignatureResult s = only_row(*simulator, r);
  // The error contains the light that the mirror could throw onto the floor, and that a sample of
  // it could miss.
  const double unseen = numerical_error(0, s.undersampling_stderr_w_sr, s.undersampling_bound_w_sr);
  EXPECT_GT(unseen, 0.001 * s.intensity_w_sr.value);
  r.accuracy.relative_error = 0;
  r.accuracy.samples_per_replicate = 1u << 18;
  const SignatureResult seen = only_row(*simulator, r);
  std::printf("asked for: %.4g +- %.2g, unseen %.2g; many samples: %.4g +- %.2g, unseen %.2g\n",
              s.intensity_w_sr.value, s.intensity_w_sr.stderr_, unseen, seen.intensity_w_sr.value,
              seen.intensity_w_sr.stderr_, seen.undersampling_stderr_w_sr);
  EXPECT_LT(std::abs(seen.intensity_w_sr.value - s.intensity_w_sr.value),
            5 * std::hypot(s.numerical_error_w_sr, seen.numerical_error_w_sr));
}

}  // namespace
}  // namespace irsig
