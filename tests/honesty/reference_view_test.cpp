// Rationale: the integrator that judges this program's error bars must itself be right, on scenes
// whose answer is a formula.
// Expected: within Student's bound of 31 degrees of freedom for 30 values, of its own standard
// error and 1e-6 (coordinates and quadratures). Source: Planck, Kirchhoff, Lambert; configuration
// factor of a rectangle [howell2010, B-4].
#include "core/scene/generate/generate_mesh.h"
#include "verify/reference/reference_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/accuracy/replicates.h"
#include "core/base/constants.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"
#include "verify/cases/bodies.h"
#include "verify/cases/hard_materials.h"
#include "verify/reference/reference_brdf.h"

namespace irsig {
namespace {

constexpr double kPi = std::numbers::pi;

ViewRequest view_of(double azimuth_deg, double elevation_deg, double range_m,
                    std::vector<double> part_temperature_k) {
  ViewRequest r;
  r.viewpoint = {azimuth_deg, elevation_deg, range_m};
  ConditionSpec condition;
  condition.part_temperature_k = std::move(part_temperature_k);
  r.condition = {condition};
  return r;
}

double black(const Band& band, double temperature_k) {
  return planck_band_radiance_w_m2_sr(band.lambda_min_um, band.lambda_max_um, temperature_k);
}

void expect_near(const Estimate& e, double expected, const std::string& what, double bias = 0) {
  const double error = std::hypot(e.stderr_, 1e-6 * expected);
  EXPECT_LE(std::abs(e.value - expected) - bias, student_t_bound(31, 30) * error)
      << what << ": " << e.value << " +- " << e.stderr_ << ", expected " << expected;
}

ReferenceView::Result run(const SceneSpec& scene, const ViewRequest& request,
                          std::uint64_t samples = 256) {
  const auto view = ReferenceView::make(scene, request, 0);
  EXPECT_TRUE(view.ok()) << view.status();
  return view->run(samples, 1);
}

TEST(ReferenceView, ABlackSphereShowsItsSilhouette) {
  const auto mesh = generate_mesh({"sphere", 2000, 1});
  ASSERT_TRUE(mesh.ok());
  const SceneSpec scene = one_body(*mesh, grey_paint(1));
  const ViewRequest request = view_of(30, 40, 1e5, {300});
  // A convex body shows its front facets from far away.
  const Vec<Body> eye = body_from_aspect(30, 40);
  double area_m2 = 0;
  for (const auto& t : mesh->triangle) {
    const Vec<Body> a = mesh->vertex[t[0]];
    area_m2 += std::max(0.0, 0.5 * dot(cross(mesh->vertex[t[1]] - a, mesh->vertex[t[2]] - a), eye));
  }
  const auto result = run(scene, request, 4096);
  // Perspective: 2 radius / range.
  expect_near(result.row[0].projected_area_m2, area_m2, "area", 2e-5 * area_m2);
  expect_near(result.row[0].total, area_m2 * black(scene.band[0], 300), "total",
              2e-5 * area_m2 * black(scene.band[0], 300));
  expect_near(result.row[0].contrast, result.row[0].apparent.value, "contrast with darkness");
}

// Whatever is reflected how often: L = B everywhere. Every model whose formula the reference has.
TEST(ReferenceView, AnIsothermalCavityIsBlack) {
  const Mesh wall = moved(spherical_cavity(50, 12, 16), {0, 0, -50});
  int models = 0;
  for (const double roughness : {1e-3, 0.1, 0.5})
    for (const HardMaterial& kind : every_material(roughness)) {
      if (!kind.bounded) continue;
      SceneSpec scene = one_body(wall, kind.spec);
      scene.band = {{"LWIR", 8, 12, 2, {}}};
      ViewRequest request = view_of(0, std::asin(50.0 / 1000) / kRadPerDeg, 1000, {300});
      request.condition[0].surroundings = {SurroundingsKind::kSea, 300, 0, 300, 1, 0};
      const auto view = ReferenceView::make(scene, request, 0);
      if (absl::IsUnimplemented(view.status())) continue;
      ASSERT_TRUE(view.ok()) << kind.name << ": " << view.status();
      ++models;
      const auto result = view->run(64, 1);
      const ReferenceView::Row& row = result.row[0];
      expect_near(row.total, row.projected_area_m2.value * black(scene.band[0], 300), kind.name);
    }
  EXPECT_GE(models, 20);
}

// eps B + rho / pi (E cos of the sun's zenith + pi L_sky), seen at 50 deg.
TEST(ReferenceView, ALambertPlateInTheSun) {
  const double emissivity = 0.3, elevation_deg = 40, sun_zenith = 35 * kRadPerDeg;
  SceneSpec scene = one_body(lying(plate(1, 2)), grey_paint(emissivity));
  scene.band = {{"MWIR", 3, 5, 0.1, {}}};
  ViewRequest request = view_of(0, elevation_deg, 1e6, {290});
  put_sun(request.condition[0], {std::sin(sun_zenith), 0, -std::cos(sun_zenith)});
  request.condition[0].surroundings.sky_temperature_k = 250;
  double sun_w_m2 = 0;
  constexpr int kSteps = 200000;
  for (int i = 0; i < kSteps; ++i)
    sun_w_m2 += solar_irradiance_w_m2_um(3 + 2 * (i + 0.5) / kSteps) * 2 / kSteps;
  const double area_m2 = 2 * std::sin(elevation_deg * kRadPerDeg);
  const double radiance =
      emissivity * black(scene.band[0], 290) +
      (1 - emissivity) * (black(scene.band[0], 250) + sun_w_m2 * std::cos(sun_zenith) / kPi);
  const auto result = run(scene, request, 1024);
  expect_near(result.row[0].total, area_m2 * radiance, "total", 1e-5 * area_m2 * radiance);
  // Behind it: nothing, or the sky. The plate lies between sensor and ground.
  expect_near(result.row[0].contrast, area_m2 * radiance, "contrast", 1e-5 * area_m2 * radiance);
}

// A small white plate below a large hot one that faces it: four rectangles' corners.
TEST(ReferenceView, TwoPlates) {
  const double side_m = 3, height_m = 2, small_m = 0.01;
  const Mesh above = moved(inside_out(lying(plate(side_m, side_m))), {0, 0, -height_m});
  SceneSpec scene =
      one_body(joined(lying(plate(small_m, small_m)), above, "hot_"), grey_paint(0.2));
  scene.material.push_back(grey_paint(1));
  scene.part = {{"small", {scene.mesh.group[0]}, 0, false, false},
                {"hot", {"hot_*"}, 1, false, true}};
  const ViewRequest request = view_of(0, 10, 1e5, {1, 600});
  const double a = 0.5 * side_m / height_m, root = std::sqrt(1 + a * a);
  const double corner = (a / root * std::atan(a / root)) / kPi;
  const double expected =
      small_m * small_m * std::sin(10 * kRadPerDeg) * 0.8 * 4 * corner * black(scene.band[0], 600);
  const auto result = run(scene, request, 2048);
  // A plate and not a point: (small / height)^2.
  expect_near(result.row[0].total, expected, "total", 1e-4 * expected);
}

// A mirror that lies before a wall throws the sun onto it: all the light that falls on the mirror
// arrives, less what it absorbs, besides the sun's own.
TEST(ReferenceView, AMirrorLightsAWall) {
  const double sun_zenith = 45 * kRadPerDeg, side_m = 0.2;
  // Light arrives 1 m up; the mirror's shadow falls 1 m down, below the wall.
  const Mesh wall = moved(plate(4, 4), {-1, 0, -2.5});
  SceneSpec scene = one_body(joined(lying(plate(side_m, side_m)), wall, "wall_"), grey_paint(0.5));
  CookTorrance flat;
  flat.constants = {{0, 3, 12}};
  flat.roughness = 1e-3;
  scene.material.push_back({"mirror", flat});
  scene.part = {{"mirror", {scene.mesh.group[0]}, 1, false, false},
                {"wall", {"wall_*"}, 0, false, false}};
  scene.band = {{"MWIR", 3, 5, 0.1, {}}};
  // Seen along the wall's normal, from where the mirror is edge on.
  ViewRequest request = view_of(0, 0, 1e5, {0, 0});
  put_sun(request.condition[0], {std::sin(sun_zenith), 0, -std::cos(sun_zenith)});
  double sun_w_m2 = 0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i)
    sun_w_m2 += solar_irradiance_w_m2_um(3 + 2 * (i + 0.5) / kSteps) * 2 / kSteps;
  const double direct = 0.5 / kPi * sun_w_m2 * std::sin(sun_zenith) * 16;  // on 16 m2
  // Reflectance of n = 3 + 12 i at 45 deg, by Fresnel.
  const auto f = ReferenceBrdf::make({"mirror", flat}, 3, 5);
  ASSERT_TRUE(f.ok());
  const std::complex<double> index(3, 12), root = std::sqrt(index * index - 0.5);
  const double c = std::sqrt(0.5);
  const double reflectance =
      0.5 * (std::norm((c - root) / (c + root)) +
             std::norm((index * index * c - root) / (index * index * c + root)));
  const double thrown = 0.5 / kPi * sun_w_m2 * side_m * side_m * std::cos(sun_zenith) * reflectance;
  const auto result = run(scene, request, 4096);
  // Light that the wall sends to the mirror and back again is below 1e-3 of it.
  expect_near(result.row[0].total, direct + thrown, "wall", 3e-5 * direct + 1e-3 * thrown);
  EXPECT_GT(thrown, 20 * result.row[0].total.stderr_) << "seen at all";
}

// Wavelengths drawn for each path give the band of a fixed quadrature.
TEST(ReferenceView, SpectraAreIntegratedWhereTheyBreak) {
  MaterialSpec notched{"notched",
                       Lambert{{{7, 0.9}, {9.9, 0.9}, {10, 0.1}, {10.1, 0.9}, {13, 0.9}}}};
  SceneSpec scene = one_body(plate(1, 1), notched);
  const ViewRequest request = view_of(0, 0, 1e6, {300});
  double expected = 0;
  constexpr int kSteps = 400000;
  for (int i = 0; i < kSteps; ++i) {
    const double l = 8 + 4 * (i + 0.5) / kSteps;
    const double notch = std::max(0.0, 1 - std::abs(l - 10) / 0.1);
    expected += (0.9 - 0.8 * notch) * planck_radiance_w_m2_sr_um(l, 300) * 4 / kSteps;
  }
  expect_near(run(scene, request, 4096).row[0].total, expected, "total");
}

// Drawing directions by the density that it states: the mean of f cos / density is the DHR, and f
// is the same both ways.
TEST(ReferenceBrdf, IsReciprocalAndDrawsWhatItStates) {
  const std::vector<double> lambda_um{10};
  for (const double roughness : {0.05, 0.3})
    for (const HardMaterial& kind : every_material(roughness)) {
      const auto f = ReferenceBrdf::make(kind.spec, 8, 12);
      if (!f.ok()) continue;
      double density = 0;
      constexpr int kDraws = 20000;
      for (int i = 0; i < kDraws; ++i) {
        const auto u = [&](std::uint64_t k) {
          return uniform(3, static_cast<std::uint64_t>(8 * i) + k);
        };
        const auto drawn = f->draw(0.7, u(0), u(1), u(2));
        if (!(drawn.density_per_sr > 0)) continue;
        const double in[3] = {drawn.x, drawn.y, drawn.z}, out[3] = {std::sqrt(1 - 0.49), 0, 0.7};
        const ReflectionGeometry there = geometry_between(in, out);
        EXPECT_NEAR(there.cos_h, drawn.at.cos_h, 1e-9);
        double here = 0, back = 0;
        f->brdf_per_sr(there, lambda_um, {&here, 1});
        f->brdf_per_sr(reversed(there), lambda_um, {&back, 1});
        EXPECT_NEAR(here, back, 1e-5 * here) << kind.name;
        // Uniform directions, judged by the density: its integral over the hemisphere is 1 less
        // what falls below the surface.
        const double z = u(3), s = std::sqrt(1 - z * z), a = 2 * kPi * u(4);
        const double any[3] = {s * std::cos(a), s * std::sin(a), z};
        density += 2 * kPi * f->density_per_sr(geometry_between(any, out)) / kDraws;
      }
      // Narrower ones are met too seldom here.
      if (f->narrowest_slope() > 0.04) {
        EXPECT_LE(density, 1.1) << kind.name;
      }
    }
}

TEST(ReferenceView, SaysWhatItCannotDo) {
  CookTorrance forced;
  forced.constants = {{0, 1.2, 5}};
  forced.forced_emissivity = 0.8;
  const SceneSpec scene = one_body(plate(1, 1), {"paper", forced});
  EXPECT_TRUE(
      absl::IsUnimplemented(ReferenceView::make(scene, view_of(0, 0, 100, {300}), 0).status()));
}

}  // namespace
}  // namespace irsig
