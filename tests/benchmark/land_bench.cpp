// CPU time of a view on land over the same view on the ground.
//
//   land_bench          prints one line a case; ratios are of one run

#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <vector>

#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/environment/environment.h"
#include "core/land/objects/land_objects.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/signature/simulator.h"

namespace irsig {
namespace {

MaterialSpec grey(double emissivity) { return {"grey", Lambert{{{0, emissivity}}}}; }

// Hills of that height, 20 km x 20 km with cells of 20 m.
std::shared_ptr<const LandScene> hills(double height_m) {
  HeightGrid grid{-10'000, -10'000, 20, 1000, 1000, {}};
  for (std::uint32_t row = 0; row <= grid.rows; ++row)
    for (std::uint32_t column = 0; column <= grid.columns; ++column) {
      const double x = grid.west_m + column * grid.spacing_m,
                   y = grid.south_m + row * grid.spacing_m;
      grid.z_m.push_back(static_cast<float>(height_m * std::sin(x / 130) * std::cos(y / 170) -
                                            (x * x + y * y) / (2 * kEarthRadiusM)));
    }
  auto field = HeightField::create(std::move(grid));
  IRSIG_CHECK(field.ok());
  auto out = std::make_shared<LandScene>();
  out->field = std::make_shared<const HeightField>(*std::move(field));
  out->surface_m = out->field->z_m(0, 0).value();
  return out;
}

// 1000 spheres 6 m across on land, each of so many facets, from 40 m to 1 km away.
std::shared_ptr<const LandScene> with_trees(const std::shared_ptr<const LandScene>& land,
                                            std::uint64_t facets) {
  ObjectModel model;
  auto mesh = generate_mesh({"sphere", facets, 3, 0, 0, 0});
  IRSIG_CHECK(mesh.ok());
  model.mesh = *std::move(mesh);
  model.material = {0};
  for (int i = 0; i < 1000; ++i) {
    const double r_m = 40 + 0.96 * i, azimuth = 2.4 * i;
    model.place.push_back({r_m * std::sin(azimuth), r_m * std::cos(azimuth), 7.0 * i, 1, 0});
  }
  auto objects = LandObjects::create({std::move(model)}, *land->field);
  IRSIG_CHECK(objects.ok());
  auto out = std::make_shared<LandScene>(*land);
  out->objects = std::make_shared<const LandObjects>(*std::move(objects));
  return out;
}

struct Scene {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
};

// A box above the ground at 25 deg, 1.5 km away, in both bands.
Scene scene_of(bool sun) {
  SceneSpec spec;
  auto mesh = generate_mesh({"box", 300, 0, 4, 3, 2});
  IRSIG_CHECK(mesh.ok());
  spec.mesh = *std::move(mesh);
  spec.material = {grey(0.6)};
  spec.part = {{"body", {"*"}, 0, false, false}};
  spec.band = {{"LWIR", 8, 12, 0.5, {}}, {"MWIR", 3.2, 5, 0.25, {}}};
  spec.spectral_breaks_um = air_band_edges_um(3, 13);
  spec.land_material = {grey(0.9)};
  Scene out;
  auto simulator = Simulator::create(spec);
  IRSIG_CHECK(simulator.ok());
  out.simulator = *std::move(simulator);
  ConditionSpec c;
  c.part_temperature_k = {310};
  c.surroundings.kind = SurroundingsKind::kGround;
  c.above_surface_m = 3;
  c.land_temperature_k = {295};
  c.sun = sun;
  c.sun_direction = normalized(Vec<Body>{0.3, 0.5, -0.8});
  c.sun_cos_zenith = -c.sun_direction.z;
  c.sun_angular_radius_deg = 0.266;
  c.sun_scale = 1;
  const WeatherSpec weather{
      {afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kRural, 23e3}},
      true,
      {SurfaceBoundary::Kind::kGround, 295, 0.9, 0},
      nullptr,
      3};
  std::vector<double> node_um;
  for (const BandGrid& grid : out.simulator->band_grids())
    node_um.insert(node_um.end(), grid.node_um.begin(), grid.node_um.end());
  auto environment =
      Environment::make({weather}, {{0, sun, c.sun_direction, 1}}, 6, std::move(node_um));
  IRSIG_CHECK(environment.ok());
  out.request.environment = *std::move(environment);
  out.request.viewpoint = {70, 25, 1500};
  out.request.condition = {c};
  out.request.selected_condition = {0};
  out.request.selected_band = {0, 1};
  out.request.accuracy.samples_per_replicate = 1u << 15;
  out.request.max_reflections = 2;
  return out;
}

double cpu_s(Scene& scene, std::shared_ptr<const LandScene> land) {
  scene.request.land = std::move(land);
  const std::clock_t begin = std::clock();
  IRSIG_CHECK(scene.simulator->simulate(scene.request).ok());
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

}  // namespace
}  // namespace irsig

int main() {
  using namespace irsig;
  const auto flat = hills(0), rough = hills(30);
  for (const bool sun : {false, true}) {
    Scene scene = scene_of(sun);
    (void)cpu_s(scene, nullptr);  // the air of the condition is made
    const double ground = cpu_s(scene, nullptr), on_flat = cpu_s(scene, flat),
                 on_hills = cpu_s(scene, rough);
    std::printf("%s: ground %.2f s; over it: flat land %.2f, hills of 30 m %.2f\n",
                sun ? "day" : "night", ground, on_flat / ground, on_hills / ground);
    // The runs take turns, because the machine's speed differs from second to second.
    for (const std::uint64_t facets : {12u, 200u, 2000u}) {
      const auto trees = with_trees(rough, facets);
      double bare_s = 0, trees_s = 0;
      for (int turn = 0; turn < 3; ++turn) {
        bare_s += cpu_s(scene, rough);
        trees_s += cpu_s(scene, trees);
      }
      std::printf("%s: hills of 30 m with 1000 objects of %zu facets over hills: %.2f\n",
                  sun ? "day" : "night", static_cast<std::size_t>(facets), trees_s / bare_s);
    }
  }
  return 0;
}
