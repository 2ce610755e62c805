// Rationale: one line of sight stands for all of the target. What is nearer or higher is seen
// through less air, and the bound of it must hold part by part: a hot part in front and a cold one
// behind do not cancel.
// Expected: the apparent intensity of black plates through the air of their own lines, each from an
// environment whose target stands where the plate does; through homogeneous air from Bouguer's law.
#include <cmath>

#include "core/environment/environment.h"
#include "core/spectral/planck.h"
#include "scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kHeightM = 10;

struct Plate {
  double forward_m, height_m, temperature_k;
};

// Plates of 1 m2 that face forward.
Mesh plates(const std::vector<Plate>& plate) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < plate.size(); ++i) {
    const double x = plate[i].forward_m, z = -plate[i].height_m, y = 3.0 * i;
    const auto first = static_cast<std::uint32_t>(mesh.vertex.size());
    mesh.group.push_back("p" + std::to_string(i));
    mesh.vertex.insert(mesh.vertex.end(), {{x, y - 0.5, z + 0.5},
                                           {x, y + 0.5, z + 0.5},
                                           {x, y + 0.5, z - 0.5},
                                           {x, y - 0.5, z - 0.5}});
    mesh.triangle.insert(mesh.triangle.end(),
                         {{first, first + 2, first + 1}, {first, first + 3, first + 2}});
    mesh.triangle_group.insert(mesh.triangle_group.end(), {i, i});
  }
  return mesh;
}

struct Case {
  double elevation_deg, range_m;
  std::vector<Plate> plate;
};

void check(const Case& c, bool atmosphere) {
  SceneSpec scene;
  scene.mesh = plates(c.plate);
  scene.material = {grey(1)};
  std::vector<double> temperature_k;
  for (std::uint32_t i = 0; i < c.plate.size(); ++i) {
    scene.part.push_back({"p" + std::to_string(i), {}, 0});
    scene.part.back().two_sided = true;
    temperature_k.push_back(c.plate[i].temperature_k);
  }
  scene.band = {{"MWIR", 3.5, 4.1, 0.3, {}}, {"LWIR", 8, 12, 0.5, {}}};
  scene.spectral_breaks_um = air_band_edges_um(3.2, 13);
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 0, c.elevation_deg, c.range_m, temperature_k);
  r.accuracy.samples_per_replicate = 8192;
  std::vector<double> node_um;
  for (const BandGrid& g : simulator->band_grids())
    node_um.insert(node_um.end(), g.node_um.begin(), g.node_um.end());
  const WeatherSpec weather{{afgl_profile(AfglProfile::kMidlatitudeSummer), {}},
                            true,
                            {LowerSpec::Kind::kRoughSea, 292, 1, 5},
                            nullptr};
  const auto environment_at = [&](double height_m) {
    auto made = Environment::make({weather}, {{0, false, {0, 0, -1}, 1}}, height_m, node_um);
    EXPECT_TRUE(made.ok()) << made.status();
    return *std::move(made);
  };
  if (atmosphere) {
    r.environment = environment_at(kHeightM);
    r.condition[0].surroundings.kind = SurroundingsKind::kSea;
    r.condition[0].sea_wind_m_s = 5;
  } else {
    r.air = {AirModel::kHomogeneous, 2e-4, 101325, 287, true};
    r.condition[0].air_temperature_k = 285;
  }
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();

  const Vec<Body> sensor = c.range_m * body_from_aspect(0, c.elevation_deg);
  std::vector<double> expected(scene.band.size(), 0.0);
  for (const Plate& p : c.plate) {
    const Vec<Body> from = sensor - Vec<Body>{p.forward_m, 0, -p.height_m};
    const double range_m = length(from);
    std::vector<double> through, path;
    if (atmosphere) {
      const auto e = environment_at(p.height_m);
      const auto seen =
          e->view({range_m, std::asin(-from.z / range_m) / kRadPerDeg, (1 / range_m) * from, {}},
                  std::vector<std::uint32_t>{0});
      ASSERT_TRUE(seen.ok()) << seen.status();
      through = (*seen)[0].transmittance;
      path = (*seen)[0].path_radiance;
    } else {
      const AirPath own = air_path(r.air, 285, range_m, node_um);
      through = own.transmittance;
      path = own.path_radiance_w_m2_sr_um;
    }
    const double area_m2 = from.x / range_m * std::pow(c.range_m / range_m, 2);
    std::size_t i = 0;
    for (std::size_t b = 0; b < scene.band.size(); ++b)
      for (const double w : simulator->band_grids()[b].band_weight) {
        expected[b] +=
            w * area_m2 *
            (planck_radiance_w_m2_sr_um(node_um[i], p.temperature_k) * through[i] + path[i]);
        ++i;
      }
  }
  for (std::size_t b = 0; b < scene.band.size(); ++b) {
    const SignatureResult& row = view->row[b];
    const double error = std::abs(row.apparent_intensity_w_sr.value - expected[b]);
    const std::string of = scene.band[b].name + (atmosphere ? ", atmosphere, " : ", ") +
                           std::to_string(c.elevation_deg) + " deg, plates " +
                           std::to_string(c.plate.size());
    std::printf("%s: %.3g of %.4g W/sr, bound %.3g\n", of.c_str(), error, expected[b],
                row.depth_bound_w_sr);
    EXPECT_LE(error, 1.02 * row.depth_bound_w_sr + 4 * row.apparent_intensity_w_sr.stderr_ +
                         4 * row.apparent_unseen_stderr_w_sr + 1e-6 * expected[b])
        << of;
    if (c.plate.size() == 1) {
      EXPECT_LT(row.depth_bound_w_sr, 3 * error + 1e-4 * expected[b]) << of;
    }
  }
}

TEST(Depth, OnePlateAwayFromWhatStandsForTheTarget) {
  for (const bool atmosphere : {false, true}) {
    check({0.5, 5000, {{100, kHeightM, 310}}}, atmosphere);
    check({0.5, 5000, {{-100, 2, 310}}}, atmosphere);
    check({0.5, 5000, {{0, 60, 260}}}, atmosphere);
    check({30, 1000, {{50, 40, 330}}}, atmosphere);
    check({60, 20000, {{0, 100, 330}}}, atmosphere);
  }
}

TEST(Depth, HotInFrontAndColdBehindDoNotCancel) {
  for (const bool atmosphere : {false, true}) {
    check({0.5, 5000, {{150, 10, 305}, {-150, 10, 270}}}, atmosphere);
    check({45, 8000, {{0, 80, 300}, {0, 2, 275}}}, atmosphere);
  }
}

}  // namespace
}  // namespace irsig
