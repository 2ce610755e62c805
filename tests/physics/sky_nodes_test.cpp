// Rationale: paths know sky and sea at nodes only, and every condition is put in afterwards. What
// the nodes can represent must come out exactly, at the target and at the aperture; contrast is a
// difference ray by ray.
// Expected: a white plate under a sky that is linear in sin(elevation) and turns with the azimuth
// in straight pieces: closed form. A black plate before a horizon: area x (B - background). Source:
// closed forms below.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/signature/measured_view.h"
#include "core/spectral/planck.h"
#include "scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

// A square of 2 m in the plane z = -3 that looks up, as one mesh of two facets.
Mesh level_plate() {
  Mesh mesh;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0}) mesh.vertex.push_back({x, y, -3});
  mesh.triangle = {{0, 3, 2}, {0, 1, 3}};  // normal towards -z: up
  mesh.triangle_group = {0, 0};
  mesh.group = {"plate"};
  return mesh;
}

struct Fake {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
  ViewEnvironments environments;
  std::vector<double> node_um;
  ThreeBounds sky_bound;  // of the last run

  // Errors of straight lines between the sky's nodes: at worst, relative to each node; and in mean
  // over the sky.
  void set_errors(double at_worst, double in_mean) {
    const std::size_t n = node_um.size();
    ViewEnvironment& e = environments.condition[0];
    auto shapes = std::make_shared<IncidentRadiance::Shapes>(e.around.shapes());
    auto thermal = std::make_shared<IncidentRadiance::Thermal>();
    auto apparent = std::make_shared<BandRows<double>>(environments.directions.count(), n);
    thermal->ring = BandRows<double>(environments.directions.count(), n);
    for (std::uint32_t k = 0; k < environments.directions.count(); ++k) {
      const std::vector<double> here = e.around.radiance(k), there = e.around.apparent(k);
      std::copy(here.begin(), here.end(), thermal->ring.row(k));
      std::copy(there.begin(), there.end(), apparent->row(k));
    }
    thermal->error.assign(environments.directions.count(), at_worst);
    e.around = IncidentRadiance(shapes, thermal, apparent, environments.directions.sky(), 1);
    e.sky_interpolation = in_mean;
  }

  // fill(direction, above): radiance at every wavelength; what arrives is 0.7 of it.
  template <typename Fill>
  void set_sky(const DirectionNodes& directions, Fill&& fill) {
    environments.directions = directions;
    ViewEnvironment e;
    const std::size_t n = node_um.size();
    e.transmittance.assign(n, 0.5);
    e.path_radiance.assign(n, 0.25);
    e.sun.assign(n, 0.0);
    e.sun_apparent.assign(n, 0.0);
    std::vector<std::vector<double>> node, apparent;
    for (std::uint32_t k = 0; k < directions.count(); ++k) {
      const double radiance = fill(directions.direction(k), k < directions.sky());
      node.emplace_back(n, radiance);
      apparent.emplace_back(n, 0.7 * radiance);
    }
    e.around = IncidentRadiance::of_spectra(node, apparent, directions.sky());
    e.background_apparent.assign(environments.behind.count(), std::vector<double>(n, 0.0));
    environments.condition = {std::move(e)};
  }
  std::vector<Estimate> run(std::uint64_t samples) {
    const ViewPlan plan = plan_with_everything(request);
    const auto view = std::make_shared<const PreparedView>(PreparedView{
        std::make_shared<const AimedView>(make_aimed_view(simulator->target(), request.viewpoint)),
        environments, plan.effects});
    MeasuredView measured(simulator->scene(), request, plan, view, {{0}, {0}}, 7);
    run_view(measured, samples, 1, RunKind::kStored);
    std::vector<Estimate> out;
    sky_bound = measured.row[0].bound[static_cast<std::size_t>(BoundOf::kSky)];
    measured.row[0].estimate.for_each([&](const Estimate& e) { out.push_back(e); });
    out.resize(11);
    return out;
  }
};

Fake fake(MaterialSpec material, double elevation_deg, double azimuth_deg = 30) {
  Fake f;
  f.simulator = simulator_of(scene_of(level_plate(), std::move(material), lwir()));
  f.request = request(*f.simulator, azimuth_deg, elevation_deg, 1000, {300});
  f.request.max_reflections = 1;
  f.node_um = f.simulator->band_grids()[0].node_um;
  return f;
}

enum Quantity { kTotal, kEmission, kSun, kSky, kSea, kParts, kApparent, kArea, kPart, kContrast };

TEST(SkyNodes, AWhitePlateUnderALinearSky) {
  constexpr double kWidthUm = 4, kPerSin = 3, kLevel = 2;
  for (const std::uint32_t azimuths : {1u, 8u}) {
    // Linear in sin(elevation); with azimuths a saw that rises from the bow to the stern: its mean
    // is that of the nodes.
    Fake f = fake(grey(0), 90);
    const DirectionNodes nodes({0, 0.1f, 0.4f, 1}, {0, 1}, azimuths);
    double mean_turn = 0;
    const auto turn = [&](Vec<Body> d) {
      return azimuths == 1 ? 0.0 : 1 + std::cos(std::atan2(d.y, d.x));
    };
    for (std::uint32_t k = 0; k < azimuths; ++k) mean_turn += turn(nodes.direction(k)) / azimuths;
    f.set_sky(nodes, [&](Vec<Body> d, bool above) {
      return above ? kLevel - kPerSin * d.z + turn(d) : 1e6;
    });
    const std::vector<Estimate> e = f.run(4096);
    const double expected = kWidthUm * e[kArea].value * (kLevel + kPerSin * 2 / 3 + mean_turn);
    expect_within_t(e[kSky], expected, 6, "sky", 2e-3, 2e-5 * expected);
    EXPECT_EQ(e[kSea].value, 0) << "a plate that looks up sees no sea";
    const double apparent = 0.7 * expected + kWidthUm * e[kArea].value * 0.25;
    expect_within_t(e[kApparent], apparent, 6, "apparent", 2e-3, 2e-5 * apparent);
  }
}

// Every sum of weights over the nodes is the weight over one node: a sky that is the same
// everywhere gives the same to the last bits, however finely it is cut.
TEST(SkyNodes, CuttingAUniformSkyChangesNothing) {
  Fake coarse = fake(*builtin_material("hull"), 35), fine = fake(*builtin_material("hull"), 35);
  const auto radiance = [](Vec<Body>, bool above) { return above ? 5.0 : 2.0; };
  coarse.set_sky(DirectionNodes(), radiance);
  fine.set_sky(DirectionNodes({0.05f, 0.2f, 0.5f, 0.9f}, {0, 0.3f}, 5), radiance);
  const std::vector<Estimate> a = coarse.run(512), b = fine.run(512);
  for (const Quantity q : {kTotal, kEmission, kSky, kSea, kApparent, kArea})
    EXPECT_NEAR(a[q].value, b[q].value, 3e-7 * std::abs(a[q].value)) << q;
}

// Lobes as wide as a white plate's see the mean error of the sky's interpolation, if that is the
// smaller one; a narrow lobe sees the worst.
TEST(SkyNodes, TheBoundIsTheErrorOfWhatIsReflected) {
  constexpr double kWidthUm = 4, kRadiance = 5;
  for (const auto& [at_worst, in_mean] : {std::pair{0.01, 1.0}, std::pair{0.01, 0.003}}) {
    Fake f = fake(grey(0), 90);
    f.set_sky(DirectionNodes({0, 0.3f, 1}, {0, 1}, 1),
              [&](Vec<Body>, bool above) { return above ? kRadiance : 0.0; });
    f.set_errors(at_worst, in_mean);
    const std::vector<Estimate> e = f.run(512);
    const double reflected = kWidthUm * kRadiance * e[kArea].value;
    EXPECT_NEAR(e[kSky].value, reflected, 1e-4 * reflected);
    EXPECT_NEAR(f.sky_bound.source, std::min(at_worst, in_mean) * reflected, 1e-5 * reflected);
  }
}

TEST(SkyNodes, SharesAddUpAndInterpolate) {
  const DirectionNodes nodes({0.02f, 0.1f, 0.5f}, {0, 0.25f, 0.99f}, 6, 0.3);
  for (int i = 0; i < 5000; ++i) {
    const double z = 2 * ((i * 0.618034) - std::floor(i * 0.618034)) - 1, phi = i * 2.399963,
                 r = std::sqrt(1 - z * z);
    const Vec<Body> d{r * std::cos(phi), r * std::sin(phi), z};
    DirectionNodes::Share share[4];
    const int n = nodes.shares(static_cast<float>(d.x), static_cast<float>(d.y),
                               static_cast<float>(d.z), share);
    double sum = 0, sine = 0;
    for (int k = 0; k < n; ++k) {
      ASSERT_LT(share[k].node, nodes.count());
      ASSERT_GE(share[k].weight, 0);
      ASSERT_EQ(share[k].node < nodes.sky(), d.z < 0);
      sum += share[k].weight;
      sine += share[k].weight * nodes.sin_elevation(share[k].node);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    const double inside = d.z < 0 ? std::clamp(-d.z, 0.02, 0.5) : -std::min(d.z, 0.99);
    EXPECT_NEAR(sine, inside, 1e-6);
  }
  for (std::uint32_t k = 0; k < nodes.count(); ++k) {
    const Vec<Body> d = nodes.direction(k);
    DirectionNodes::Share share[4];
    const float z = static_cast<float>(d.z);
    const int n = nodes.shares(static_cast<float>(d.x), static_cast<float>(d.y),
                               k < nodes.sky() ? z : std::max(z, 0.0f), share);
    float own = 0;
    for (int i = 0; i < n; ++i) own += share[i].node == k ? share[i].weight : 0;
    EXPECT_NEAR(own, 1, 1e-4) << "node " << k;
  }
}

// A black plate, 300 K, seen against a background whose radiance changes with the elevation.
TEST(Contrast, IsADifferenceRayByRay) {
  for (const double elevation_deg : {60.0, 20.0}) {
    Fake f = fake(grey(1), elevation_deg);
    f.set_sky(DirectionNodes(), [](Vec<Body>, bool) { return 1.0; });
    // The line of sight goes to the plate's middle, 3 m above the reference point.
    const Vec<Body> line = 1000 * body_from_aspect(30, elevation_deg) - Vec<Body>{0, 0, -3};
    const double s = -line.z / length(line);
    const std::vector<float> rings{static_cast<float>(s) - 0.01f, static_cast<float>(s) + 0.01f};
    f.environments.behind = BackgroundDirections({0, rings[0], rings[1]});
    // 4 W/(m2 sr um) at the mean elevation, the sky's node must not be met.
    ViewEnvironment& e = f.environments.condition[0];
    e.background_apparent.clear();
    for (const double radiance : {1e9, 3.5, 4.5})
      e.background_apparent.emplace_back(f.node_um.size(), radiance);
    const std::vector<Estimate> q = f.run(4096);
    const double emitted = planck_band_radiance_w_m2_sr(8, 12, 300);
    const double expected = q[kArea].value * (0.5 * emitted - 4 * 4);
    EXPECT_NEAR(q[kContrast].value, expected, 3e-4 * std::abs(q[kArea].value) * 16)
        << elevation_deg;
    EXPECT_NEAR(q[kContrast + 1].value, 4 * (4 + 0.25), 1e-2) << "background at the aperture";
    EXPECT_NEAR(q[kApparent].value, q[kArea].value * (0.5 * emitted + 4 * 0.25),
                1e-6 * q[kApparent].value);
  }
}

}  // namespace
}  // namespace irsig
