// Rationale: convex bodies, occlusion, finite range and single reflections have closed forms; a
// reverse Monte Carlo that is
//   right must meet them within its own standard error.
// Expected: |t| within the bound of docs/explanation/methods.md for the number of rows of this
// file, at a standard error <= 0.1 %. Source: closed forms (areas of projections, solid angles,
// Lambert sphere); values computed independently with numpy,
//   printed here. Radiance L = 0.8 B(8-12 um, 400 K) = 106.9927036771598 W/(m2 sr).
// Geometry: 200 k triangles, scaled by the generators so that mean cross sections are those of the
// smooth body; the
//   remaining relative error of a projected area (stated with each generator) is below 2e-5 and is
//   allowed for.
#include <numbers>

#include "core/materials/spectra.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;
constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kRows = 45;
constexpr double kRange =
    1e6;  // a face 1 m nearer than the reference point is 2e-6 brighter: the far field

struct FormRow {
  double azimuth_deg, elevation_deg, intensity_w_sr;
};

// Emission only, emissivity 0.8 at 400 K.
void expect_rows(const Mesh& mesh, const std::string& name, const std::vector<FormRow>& rows) {
  const auto simulator = simulator_of(scene_of(mesh, grey(0.8), lwir()));
  for (const FormRow& row : rows) {
    const auto r = only_row(*simulator,
                            request(*simulator, row.azimuth_deg, row.elevation_deg, kRange, {400}));
    expect_within_t(r.intensity_w_sr, row.intensity_w_sr, kRows,
                    name + " az " + std::to_string(row.azimuth_deg) + " el " +
                        std::to_string(row.elevation_deg),
                    1e-3, 2e-5 * row.intensity_w_sr);
  }
}

TEST(ClosedForms, Sphere) {
  expect_rows(generated("sphere", 200000), "sphere",
              {{0, 0, 336.1274918598749}, {123, 41, 336.1274918598749}});
}

TEST(ClosedForms, Box) {
  expect_rows(generated("box", 1200), "box",
              {{90, 0, 106.9927036771598},
               {0, 90, 213.9854073543196},
               {30, 20, 166.9926538414928},
               {45, 35.264389682754654, 216.2029319426692}});
}

TEST(ClosedForms, Cylinder) {
  expect_rows(generated("cylinder", 200000), "cylinder",
              {{0, 0, 84.03187296496871},
               {15, 0, 164.2438045242838},
               {90, 0, 320.9781110314794},
               {120, 0, 319.9911346944877}});
}

TEST(ClosedForms, Cone) {
  expect_rows(generated("cone", 200000), "cone",
              {{0, 0, 336.1274918598749},
               {26.565051177077989, 0, 300.641568362075},
               {45, 0, 289.4907843298172},
               {135, 0, 289.4907843298172},
               {170, 0, 331.0209599841526},
               {180, 0, 336.1274918598749}});
}

TEST(ClosedForms, OneSidedDisk) {
  const Mesh disk = generated("disk", 20000);
  expect_rows(disk, "disk",
              {{0, 0, 336.1274918598749}, {60, 0, 168.0637459299374}, {89, 0, 5.866233602683241}});
  const auto simulator = simulator_of(scene_of(disk, grey(0.8), lwir()));
  const auto view = simulator->simulate(request(*simulator, 120, 0, kRange, {400}));
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view->row[0].intensity_w_sr.value, 0);
  EXPECT_EQ(view->row[0].projected_area_m2.value, 0);
  EXPECT_GT(view->guarded_backface_hits, 0u);
}

TEST(ClosedForms, Ellipsoid) {
  expect_rows(moved(generated("sphere", 200000), {}, {3, 1, 0.7}), "ellipsoid",
              {{0, 0, 235.2892443019124}, {0, 90, 1008.382475579625}, {40, 25, 614.3238079832986}});
}

TEST(ClosedForms, CapsuleOfOverlappingSolids) {
  const Mesh ball = generated("sphere", 100000, 0.5);
  Mesh capsule = joined(generated("cylinder", 100000, 0.5, 4), moved(ball, {2, 0, 0}), "bow_");
  capsule = joined(capsule, moved(ball, {-2, 0, 0}), "stern_");
  expect_rows(capsule, "capsule", {{30, 0, 298.0172803192883}, {90, 0, 512.0026876736079}});
}

TEST(ClosedForms, SphereInFrontOfDisk) {
  SceneSpec scene = scene_of(joined(moved(generated("sphere", 200000, 0.5), {2, 0, 0}),
                                    generated("disk", 20000, 1.5), "disk_"),
                             grey(0.9), lwir());
  scene.material.push_back({"disk", Lambert{{{0, 0.7}}}});
  scene.part = {{"sphere", {"sphere"}, 0, false, true}, {"disk", {"disk_*"}, 1, false, false}};
  const auto simulator = simulator_of(scene);
  for (const FormRow row : {FormRow{10, 0, 371.3104700206522},
                            {20, 0, 362.7160182858358},
                            {40, 0, 344.3408571805333},
                            {50, 0, 327.322201903723},
                            {80, 0, 237.950942053103}}) {
    const auto r =
        only_row(*simulator, request(*simulator, row.azimuth_deg, 0, kRange, {500, 300}));
    expect_within_t(r.intensity_w_sr, row.intensity_w_sr, kRows,
                    "sphere before disk, " + std::to_string(row.azimuth_deg), 1e-3,
                    2e-5 * row.intensity_w_sr);
    // Parts partition the intensity.
    EXPECT_NEAR(r.part_w_sr[0].value + r.part_w_sr[1].value, r.intensity_w_sr.value,
                1e-9 * r.intensity_w_sr.value);
  }
}

// range^2 x solid angle, without the cosine at the sensor.
TEST(ClosedForms, FiniteRange) {
  const double radiance = 0.8 * planck_band_radiance_w_m2_sr(8, 12, 400);
  const auto expect = [&](const Mesh& mesh, double range_m, double solid_angle_sr,
                          const std::string& what, double model) {
    const auto simulator = simulator_of(scene_of(mesh, grey(0.8), lwir()));
    const auto r = only_row(*simulator, request(*simulator, 0, 0, range_m, {400}));
    const double expected = radiance * range_m * range_m * solid_angle_sr;
    expect_within_t(r.intensity_w_sr, expected, kRows, what, 1e-3, model * expected);
  };
  for (const double range : {51.0, 500.0})
    expect(generated("disk", 20000, 50), range, 2 * kPi * (1 - range / std::hypot(range, 50)),
           "disk R 50 at " + std::to_string(range), 2e-5);
  const double sphere = 1.010205144336438 * kPi * 100 / (50 * 50);  // sphere R 10 at 50 m
  expect(generated("sphere", 400000, 10), 50, sphere, "sphere R 10 at 50 m", 4e-5);
  // Rectangle a x b on the axis at d: 4 asin(ab / sqrt((a^2 + 4 d^2)(b^2 + 4 d^2))); the near face
  // of a thin box.
  const double a = 153.8, b = 6.4, d = 100;
  expect(moved(generated("box", 1200, 0, 1e-3, a, b), {-0.5e-3, 0, 0}), d,
         4 * std::asin(a * b / std::sqrt((a * a + 4 * d * d) * (b * b + 4 * d * d))),
         "rectangle 153.8 x 6.4 at 100 m", 2e-5);
}

// Sunlight of 1000 W/m2 in band on a body at 0 K.
ViewRequest sunlit(const Simulator& simulator, const Band& band, double azimuth_deg,
                   Vec<Body> sun) {
  ViewRequest r = request(simulator, azimuth_deg, 0, kRange, {0});
  r.max_reflections = 1;
  ConditionSpec& c = r.condition[0];
  c.sun = true;
  c.sun_cos_zenith = 0.5;  // only says that the sun is up
  c.sun_angular_radius_deg = 1e-4;
  c.sun_direction = sun;
  double in_band = 0;
  const BandGrid& grid = simulator.band_grids()[0];
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    in_band += grid.band_weight[i] * solar_irradiance_w_m2_um(grid.node_um[i]);
  c.sun_scale = 1000 / in_band;
  static_cast<void>(band);
  return r;
}

TEST(ClosedForms, LambertSphereInTheSun) {
  const auto simulator = simulator_of(scene_of(generated("sphere", 200000), grey(0.7), mwir()));
  // Flat facets differ from the smooth sphere where the sun grazes: facets span d = sqrt(4 pi / (N
  // sqrt(3) / 2)) = 0.0085 rad, and a crescent of width w = 180 deg - phase is wrong by about (d /
  // w)^2 / 4.
  const struct {
    double phase_deg, intensity_w_sr, facets;
  } rows[] = {{0, 200.0, 2e-5},
              {60, 121.7995562088459, 2e-5},
              {90, 63.66197723675813, 5e-5},
              {150, 2.963475158897779, 1e-4}};
  for (const auto& row : rows) {
    ViewRequest r =
        sunlit(*simulator, mwir(), 0,
               {std::cos(row.phase_deg * kPi / 180), std::sin(row.phase_deg * kPi / 180), 0});
    r.accuracy.samples_per_replicate = row.phase_deg > 140 ? 1u << 16 : 1u << 14;
    expect_within_t(only_row(*simulator, r).intensity_w_sr, row.intensity_w_sr, kRows,
                    "Lambert sphere, phase " + std::to_string(row.phase_deg), 1e-3,
                    row.facets * row.intensity_w_sr);
  }
}

// A thin crescent: 170 deg, facets of 0.0027 rad (2 M triangles): (d / w)^2 / 4 = 6e-5.
TEST(ClosedForms, LambertSphereCrescent) {
  const auto simulator = simulator_of(scene_of(generated("sphere", 2000000), grey(0.7), mwir()));
  ViewRequest r =
      sunlit(*simulator, mwir(), 0, {std::cos(170 * kPi / 180), std::sin(170 * kPi / 180), 0});
  r.accuracy.samples_per_replicate = 1u << 20;
  expect_within_t(only_row(*simulator, r).intensity_w_sr, 0.1124779670343403, kRows,
                  "Lambert sphere, phase 170", 1e-3, 6e-5 * 0.1124779670343403);
}

TEST(ClosedForms, PlatesInTheSun) {
  // A disk of 1 m2: I = f E cos_i cos_r A. Incidence i towards +y of the normal +x; view r from the
  // other side for 180 deg.
  const Mesh plate = generated("disk", 400, std::sqrt(1 / kPi));
  struct PlateRow {
    double i_deg, r_deg, dphi_deg, intensity_w_sr;
  };
  const auto expect = [&](const Simulator& simulator, const PlateRow& row,
                          const std::string& name) {
    // The view lies in the horizontal plane, the sun at azimuth dphi about the normal.
    const double i = row.i_deg * kPi / 180, phi = row.dphi_deg * kPi / 180;
    const Vec<Body> sun{std::cos(i), std::sin(i) * std::cos(phi), std::sin(i) * std::sin(phi)};
    ViewRequest r = sunlit(simulator, mwir(), row.r_deg, sun);
    r.accuracy.samples_per_replicate = 1u << 15;
    expect_within_t(only_row(simulator, r).intensity_w_sr, row.intensity_w_sr, kRows,
                    name + " " + std::to_string(row.i_deg) + " " + std::to_string(row.r_deg) + " " +
                        std::to_string(row.dphi_deg),
                    1e-3, 2e-5 * row.intensity_w_sr);
  };
  const auto lambert = simulator_of(scene_of(plate, grey(0.7), mwir()));
  for (const PlateRow row : {PlateRow{0, 0, 0, 95.4929658551372},
                             {30, 30, 180, 71.6197243913529},
                             {60, 0, 0, 47.7464829275686},
                             {75, 75, 180, 6.396815770934197}})
    expect(*lambert, row, "Lambert plate");
  CookTorrance lobe;
  lobe.constants = {{0, 1.2, 5.0}};
  lobe.fresnel = Fresnel::kSchlick;
  const auto rough = simulator_of(scene_of(plate, {"rough", lobe}, mwir()));
  for (const PlateRow row : {PlateRow{0, 0, 0, 741.9645097968907},
                             {30, 30, 0, 32.49095856920642},
                             {60, 60, 180, 746.4091853747475},
                             {60, 30, 90, 4.328619053582868},
                             {75, 75, 180, 773.777998851417},
                             {30, 60, 170, 359.7472157639892}})
    expect(*rough, row, "Cook-Torrance plate");
}

// A one-sided plate of 1 m2 beside one of 3 m2 that shows its back.
TEST(ClosedForms, BackfaceFractionIsOfTheArea) {
  Mesh mesh;
  mesh.group = {"plate"};
  mesh.vertex = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {4, 0, 0}, {4, 1, 0}};
  mesh.triangle = {{0, 2, 1}, {0, 3, 2}, {1, 4, 5}, {1, 5, 2}};
  mesh.triangle_group = {0, 0, 0, 0};
  const auto simulator = simulator_of(scene_of(mesh, grey(1), lwir()));
  const SignatureResult row = only_row(*simulator, request(*simulator, 0, 90, 1e6, {300}));
  EXPECT_NEAR(row.backface_fraction, 0.75, 1e-3);
  EXPECT_NEAR(row.projected_area_m2.value, 1, 4e-3);
}

// An emissivity that goes up and down between the points of its table, which are where they may be:
// on stored wavelengths, a rounding beside the limits of the band, too many to cut at. The truth is
// a sum over 400 000 wavelengths.
TEST(ClosedForms, TablesOfManyPointsWithinTheQuadraturesBound) {
  constexpr double kLow = 0.2, kHigh = 0.9, kBegin_um = 2.5, kEnd_um = 6.5;
  constexpr int kFine = 400000;
  for (const double step_um : {1.0, 0.3, 0.1, 0.03, 0.01, 0.002}) {
    Lambert saw;
    for (double um = kBegin_um; um < kEnd_um; um += step_um)
      saw.emissivity.push_back({um, saw.emissivity.size() % 2 == 0 ? kLow : kHigh});
    const auto simulator =
        simulator_of(scene_of(generated("box", 12), MaterialSpec{"saw", saw}, mwir()));
    for (const double temperature_k : {200.0, 300.0, 2000.0}) {
      const SignatureResult row =
          only_row(*simulator, request(*simulator, 0, 90, 1e6, {temperature_k}));
      double truth = 0, black = 0;
      for (int i = 0; i < kFine; ++i) {
        const double um = 3 + 2 * (i + 0.5) / kFine;
        const double radiance = 2.0 / kFine * planck_radiance_w_m2_sr_um(um, temperature_k);
        truth += radiance * spectrum_at(saw.emissivity, um);
        black += radiance;
      }
      const double area_m2 = row.projected_area_m2.value;
      const double off = row.intensity_w_sr.value / area_m2 - truth;
      const double bound = row.quadrature_bound_w_sr / area_m2;
      EXPECT_LT(std::abs(off), bound + 1e-7 * truth)
          << step_um << " um, " << temperature_k << " K: " << truth;
      if (step_um > 0.005)
        EXPECT_LT(bound, 1e-4 * truth) << step_um << " um, " << temperature_k << " K";
      else  // lines between few points may be half a tooth off everywhere
        EXPECT_GT(bound, 0.5 * (kHigh - kLow) * black) << temperature_k << " K";
    }
  }
}

// An emissivity that rises over the whole of a band whose step is as wide: the quadrature of a
// blackbody says nothing of it.
TEST(ClosedForms, ASteepEmissivityOverAWideStepWithinTheQuadraturesBound) {
  constexpr int kFine = 20000;
  double closest = 0;
  for (const bool rises : {true, false})
    for (const Band& band : {Band{"wide", 6, 10, 4, {}}, Band{"half", 6, 10, 2, {}}}) {
      const Lambert slope{{{2, rises ? 0.02 : 0.98}, {14, rises ? 0.98 : 0.02}}};
      const auto simulator =
          simulator_of(scene_of(generated("box", 12), MaterialSpec{"slope", slope}, band));
      for (double temperature_k = 180; temperature_k < 600; temperature_k += 20) {
        const SignatureResult row =
            only_row(*simulator, request(*simulator, 0, 90, 1e6, {temperature_k}));
        double truth = 0;
        for (int i = 0; i < kFine; ++i) {
          const double um = 6 + 4 * (i + 0.5) / kFine;
          truth += 4.0 / kFine * planck_radiance_w_m2_sr_um(um, temperature_k) *
                   spectrum_at(slope.emissivity, um);
        }
        const double off = row.intensity_w_sr.value / row.projected_area_m2.value / truth - 1;
        const double bound = row.quadrature_bound_w_sr / row.intensity_w_sr.value;
        EXPECT_LT(std::abs(off), bound + 1e-7) << band.name << ", " << temperature_k << " K";
        closest = std::max(closest, std::abs(off) / bound);
      }
    }
  EXPECT_GT(closest, 0.3) << "a bound that is always far too wide says nothing";
}

}  // namespace
}  // namespace irsig
