// Rationale: the sun mirrored by the sea lights the hull from below. Paths that end on the sea look
// for the sun from there, so that what they find must be the integral of the glitter, and nothing
// where the body itself stands in the sun.
// Expected: an upright white plate: the integral of E rho glint_per_sr cos over what it sees below
// the horizon, by quadrature. Under a roof that shades the sea before it: nearly nothing. Source:
// core/environment/sea/sea_surface.h; quadrature below.
#include "core/environment/sea/sea_glint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/environment/sea/sea_surface.h"
#include "core/signature/measured_view.h"
#include "scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kLambdaUm = 4;

Vec<Body> sun_at(double elevation_deg) {
  const double e = elevation_deg * std::numbers::pi / 180;
  return {std::cos(e) * 0.8, std::cos(e) * 0.6, -std::sin(e)};
}

// Irradiance on a plate that looks towards +x, per unit irradiance of the sun.
double glitter_on_plate(Vec<Body> sun, double wind_m_s) {
  constexpr int kZeniths = 1500, kAzimuths = 1500;
  const std::complex<double> index = sea_water_index(kLambdaUm);
  double sum = 0;
  for (int i = 0; i < kZeniths; ++i) {
    const double z = (i + 0.5) / kZeniths, r = std::sqrt(1 - z * z);
    for (int k = 0; k < kAzimuths; ++k) {
      const double phi = std::numbers::pi * ((k + 0.5) / kAzimuths - 0.5);
      const SeaGlint g = sea_glint({-r * std::cos(phi), -r * std::sin(phi), -z}, sun, wind_m_s);
      if (g.per_sr > 0)
        sum += static_cast<double>(g.per_sr) *
               water_reflectance(index, static_cast<double>(g.cos_incidence)) * r * std::cos(phi);
    }
  }
  return sum * std::numbers::pi / (static_cast<double>(kZeniths) * kAzimuths);
}

// A plate of 1 m2 at 3 m above the water, and, if roofed, 100 m x 100 m of black roof at 8 m.
Mesh plate_at_sea(bool roofed) {
  Mesh mesh;
  for (const double y : {-0.5, 0.5})
    for (const double z : {-3.5, -2.5}) mesh.vertex.push_back({0, y, z});
  mesh.triangle = {{0, 2, 3}, {0, 3, 1}};
  mesh.triangle_group = {0, 0};
  mesh.group = {"plate"};
  if (!roofed) return mesh;
  for (const double x : {-50.0, 50.0})
    for (const double y : {-50.0, 50.0}) mesh.vertex.push_back({x, y, -8});
  mesh.triangle.insert(mesh.triangle.end(), {{4, 6, 7}, {4, 7, 5}});
  mesh.triangle_group.insert(mesh.triangle_group.end(), {1, 1});
  mesh.group.push_back("roof");
  return mesh;
}

struct Lit {
  Estimate sea, apparent, area;
};
Lit lit_by_glitter(bool roofed, double elevation_deg, double wind_m_s) {
  SceneSpec scene = scene_of(plate_at_sea(roofed), grey(0), {"narrow", 3.95, 4.05, 0.1, {}});
  scene.material.push_back(grey(1));
  scene.part = {{"plate", {"plate"}, 0, true, false}};
  if (roofed) scene.part.push_back({"roof", {"roof"}, 1, true, false});
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 0, 0.5, 5000, std::vector<double>(scene.part.size(), 0.0));
  r.max_reflections = 1;
  ConditionSpec& c = r.condition[0];
  c.surroundings.kind = SurroundingsKind::kSea;
  c.sun = true;
  c.sun_direction = sun_at(elevation_deg);
  c.sun_cos_zenith = -c.sun_direction.z;
  c.sun_angular_radius_deg = 0.266;
  c.sun_scale = 1;
  c.sea_wind_m_s = wind_m_s;
  const std::vector<double> node_um = simulator->band_grids()[0].node_um;
  const std::vector<double> zero(node_um.size(), 0.0), one(node_um.size(), 1.0);
  ViewEnvironment e;
  e.transmittance = e.sun = one;
  e.path_radiance = zero;
  e.sun_apparent.assign(node_um.size(), 0.25);
  e.background_apparent = {zero, zero};
  e.around = IncidentRadiance::of_spectra(e.background_apparent, e.background_apparent);
  ViewEnvironments environments;
  environments.condition = {e};
  const ViewPlan plan = plan_with_everything(r);
  const auto view = std::make_shared<const PreparedView>(PreparedView{
      std::make_shared<const AimedView>(make_aimed_view(simulator->target(), r.viewpoint)),
      environments, plan.effects});
  MeasuredView measured(simulator->scene(), r, plan, view, {{0}, {0}}, 5);
  run_view(measured, 1u << 13, 1, RunKind::kStored);
  const RowEstimate& lit = measured.row[0].estimate;
  return {lit.cause[static_cast<std::size_t>(Cause::kSeaReflected)], lit.apparent, lit.part[0]};
}

TEST(SeaGlint, LightsAPlate) {
  for (const double elevation_deg : {15.0, 50.0})
    for (const double wind_m_s : {2.0, 10.0}) {
      const double width_um = 0.1;
      const Lit plate = lit_by_glitter(false, elevation_deg, wind_m_s);
      const double expected =
          width_um * glitter_on_plate(sun_at(elevation_deg), wind_m_s) / std::numbers::pi;
      expect_within_t(
          plate.sea, expected, 4,
          "sun " + std::to_string(elevation_deg) + " deg, wind " + std::to_string(wind_m_s), 1e-2,
          2e-2 * expected);
      const Lit shaded = lit_by_glitter(true, elevation_deg, wind_m_s);
      // Sea that the roof leaves in the sun lies farther away, where a low sun glitters.
      EXPECT_LT(shaded.sea.value, (elevation_deg > 40 ? 0.05 : 0.4) * plate.sea.value);
    }
}

// Between its nodes the reflectance is taken for linear in (1 - cos)^3.
TEST(SeaGlint, ReflectanceBetweenItsNodes) {
  double worst = 0;
  for (const double lambda_um : {3.1, 3.5, 4.0, 5.0, 8.0, 10.0, 12.0, 14.0})
    for (int i = 0; i <= 1000; ++i) {
      const double cosine = i / 1000.0;
      const std::complex<double> index = sea_water_index(lambda_um);
      const GlintShare at = glint_fraction(static_cast<float>(cosine));
      const auto node = [&](std::size_t k) {
        return water_reflectance(index, static_cast<double>(kGlintCosines[k]));
      };
      const double linear =
          std::lerp(node(at.node), node(at.node + 1), static_cast<double>(at.weight_of_next));
      worst = std::max(worst, std::abs(linear / water_reflectance(index, cosine) - 1));
    }
  std::printf("largest error: %.4f of the reflectance\n", worst);
  EXPECT_LT(worst, 0.022);
}

}  // namespace
}  // namespace irsig
