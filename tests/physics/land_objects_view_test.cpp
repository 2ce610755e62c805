// Rationale: objects on land take part in all that a view computes: they hide and shade the target
// and the land, stand behind the target, are mirrored in it, and are seen in pictures.
// Expected: closed forms of what a wall hides and shades; a bank of the height field and the same
// bank as an object give the same rows; black objects of the land's temperature are not seen.
// Source: straight lines; the height field; Kirchhoff.
#include <array>
#include <cmath>

#include "core/land/objects/land_objects.h"
#include "core/spectral/planck.h"
#include "land_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

// Adds objects of the land's first material, or another one.
std::shared_ptr<const LandScene> with_objects(
    const std::shared_ptr<const LandScene>& land,
    const std::vector<std::pair<Mesh, std::vector<ObjectPlace>>>& meshes,
    std::uint32_t material = 0) {
  std::vector<ObjectModel> models;
  for (const auto& [mesh, place] : meshes) {
    ObjectModel& model = models.emplace_back();
    model.key = absl::StrCat("land.object[", models.size() - 1, "]");
    model.mesh = mesh;
    model.material.assign(mesh.group.size(), material);
    model.place = place;
  }
  auto objects = LandObjects::create(std::move(models), *land->field);
  EXPECT_TRUE(objects.ok()) << objects.status();
  auto out = std::make_shared<LandScene>(*land);
  out->objects = std::make_shared<const LandObjects>(*std::move(objects));
  return out;
}

Mesh block(double length_m, double width_m, double height_m) {
  return generated("box", 12, 0, length_m, width_m, height_m);
}

ObjectPlace at_azimuth(double azimuth_deg, double distance_m) {
  return {distance_m * std::sin(azimuth_deg * kRadPerDeg),
          distance_m * std::cos(azimuth_deg * kRadPerDeg), azimuth_deg, 1, 0};
}

// The sensor is at azimuth 70 from the bow, which points to 30.
constexpr double kSensorDeg = 100;

// The box reaches from 2 to 4 m above the land; sight rises by 1 deg. A wall whose upper edge is
// where sight from a height of 3 m passes hides half of the upright faces and nothing of the lid.
TEST(LandObjectsView, AWallHidesTheLowerPart) {
  Scene scene = scene_on(1, 20'000, false);
  scene.request.accuracy.samples_per_replicate = 4096;
  const auto land = land_of(flat, 300, 10);
  const double whole_m2 = view_of(scene, land).row[0].projected_area_m2.value;
  const double near_m = 30, wall_m = 3 + near_m * std::tan(1 * kRadPerDeg);
  const ViewResult view = view_of(
      scene, with_objects(land, {{block(2, 300, wall_m), {at_azimuth(kSensorDeg, near_m + 1)}}}));
  const SignatureResult& r = view.row[0];
  const double lid_m2 = 4 * 3 * std::sin(1 * kRadPerDeg);
  EXPECT_NEAR(r.projected_area_m2.value, lid_m2 + 0.5 * (whole_m2 - lid_m2), 0.01 * whole_m2);
  EXPECT_NEAR(r.clutter->visible_fraction, r.projected_area_m2.value / whole_m2, 2e-3);
  // A wall that hides all of it is an error, and one behind the target hides nothing.
  scene.request.land =
      with_objects(land, {{block(2, 300, 12), {at_azimuth(kSensorDeg, near_m + 1)}}});
  EXPECT_NE(
      scene.simulator->simulate(scene.request).status().message().find("land hides all of it"),
      std::string::npos);
  const ViewResult behind = view_of(
      scene, with_objects(land, {{block(2, 300, 12), {at_azimuth(kSensorDeg + 180, near_m)}}}));
  EXPECT_NEAR(behind.row[0].projected_area_m2.value, whole_m2, 1e-3 * whole_m2);
}

TEST(LandObjectsView, AWallShadesTheTarget) {
  Scene scene = scene_on(70, 1500, true);
  const ConditionSpec& c = scene.request.condition[0];
  const double azimuth_deg = 30 + std::atan2(c.sun_direction.y, c.sun_direction.x) / kRadPerDeg;
  const double tangent = -c.sun_direction.z / std::hypot(c.sun_direction.x, c.sun_direction.y);
  const auto land = land_of(flat, 2000, 10);
  const auto sunlit = [&](const std::shared_ptr<const LandScene>& here) {
    return view_of(scene, here)
        .row[1]
        .cause_w_sr[static_cast<std::size_t>(Cause::kSunReflected)]
        .value;
  };
  const auto walled = [&](double height_m) {
    return with_objects(land, {{block(2, 400, height_m), {at_azimuth(azimuth_deg, 51)}}});
  };
  const double open = sunlit(land);
  EXPECT_GT(open, 0);
  EXPECT_NEAR(sunlit(walled(40 * tangent)), open, 1e-6 * open);
  EXPECT_EQ(sunlit(walled(80 * tangent)), 0);
}

// A bank whose face rises from x = 29 m to x = 30 m, in the frame of its middle: forward is east.
Mesh bank_mesh(double half_length_m, double half_width_m, double height_m) {
  const double a = -half_length_m, b = half_length_m, w = half_width_m;
  Mesh out;
  for (const double y : {-w, w})
    for (const Vec<Body>& v : {Vec<Body>{a, y, 0}, Vec<Body>{a + 1, y, -height_m},
                               Vec<Body>{b - 1, y, -height_m}, Vec<Body>{b, y, 0}})
      out.vertex.push_back(v);
  const std::array<std::array<std::uint32_t, 4>, 6> quads = {
      {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
  for (const auto& q : quads) {
    out.triangle.push_back({q[0], q[1], q[2]});
    out.triangle.push_back({q[0], q[2], q[3]});
  }
  out.triangle_group.assign(12, 0);
  out.group = {"bank"};
  return out;
}

TEST(LandObjectsView, ABankOfTheHeightFieldIsTheSameAsAnObject) {
  const double height_m = 3.5;
  // Vertices stand every metre: the faces are those of the object.
  const Height bank = [&](double x, double y) {
    return x > 29.5 && x < 69.5 && std::abs(y) < 79.5 ? height_m : 0.0;
  };
  for (const double elevation_deg : {1.0, 25.0}) {
    Scene scene = scene_on(elevation_deg, 900, true);
    scene.request.accuracy.samples_per_replicate = 4096;
    ImageSpec image;
    image.width_px = image.height_px = 32;
    image.margin = 4;
    image.layer = {ImageLayer::kBackground, ImageLayer::kAtSensor};
    scene.request.image = image;
    const ViewResult field = view_of(scene, land_of(bank, 300, 1));
    const ViewResult object =
        view_of(scene, with_objects(land_of(flat, 300, 1),
                                    {{bank_mesh(20.5, 80, height_m), {{49.5, 0, 90, 1, 0}}}}));
    for (std::size_t i = 0; i < 2; ++i) {
      const SignatureResult &a = field.row[i], &b = object.row[i];
      const auto same = [](const char* what, const Estimate& x, const Estimate& y, double of) {
        EXPECT_LT(std::abs(x.value - y.value), 3 * std::hypot(x.stderr_, y.stderr_) + 1e-3 * of)
            << what << " " << x.value << " " << y.value;
      };
      const double of = std::abs(a.intensity_w_sr.value);
      same("area", a.projected_area_m2, b.projected_area_m2, a.projected_area_m2.value);
      same("source", a.intensity_w_sr, b.intensity_w_sr, of);
      same("apparent", a.apparent_intensity_w_sr, b.apparent_intensity_w_sr, of);
      same("contrast", a.contrast_intensity_w_sr, b.contrast_intensity_w_sr, of);
      same("background", a.background_radiance_w_m2_sr, b.background_radiance_w_m2_sr,
           a.background_radiance_w_m2_sr.value);
      for (std::size_t cause = 0; cause < kCauses; ++cause)
        same("cause", a.cause_w_sr[cause], b.cause_w_sr[cause], of);
      EXPECT_NEAR(a.clutter->clutter_mean_w_m2_sr.value, b.clutter->clutter_mean_w_m2_sr.value,
                  1e-3 * a.clutter->clutter_mean_w_m2_sr.value);
      EXPECT_NEAR(a.clutter->clutter_sigma_w_m2_sr.value, b.clutter->clutter_sigma_w_m2_sr.value,
                  0.02 * a.clutter->clutter_sigma_w_m2_sr.value);
      double difference = 0, sum = 0;
      for (std::size_t p = 0; p < a.layer[0].value.size(); ++p) {
        difference += static_cast<double>(std::abs(a.layer[0].value[p] - b.layer[0].value[p]));
        sum += static_cast<double>(a.layer[0].value[p]);
      }
      EXPECT_LT(difference, 2e-3 * sum) << elevation_deg;
    }
  }
}

// A tower beside the target: its shadow lies on the land, and the land has none of it at night.
TEST(LandObjectsView, APictureShowsTheShadowOfAnObject) {
  ImageSpec image;
  image.width_px = image.height_px = 48;
  image.margin = 4;
  image.layer = {ImageLayer::kBackground, ImageLayer::kAtSensor};
  const auto land = land_of(flat, 500, 10);
  std::array<int, 2> dark{}, changed{};
  for (const bool sun : {false, true}) {
    std::vector<float> background[2];
    for (const bool tower : {false, true}) {
      Scene scene = scene_on(60, 400, sun);
      scene.request.image = image;
      scene.request.viewpoint.aspect_azimuth_deg = -20;  // the shadow falls to a side
      // Sunlight is most of what this land sends in the short band.
      scene.request.condition[0].land_temperature_k = {260};
      const ViewResult view =
          view_of(scene, tower ? with_objects(land, {{block(2, 8, 6), {{8, 8, 10, 1, 0}}}}) : land);
      background[tower ? 1 : 0] = view.row[1].layer[0].value;
    }
    for (std::size_t i = 0; i < background[0].size(); ++i) {
      const double ratio = static_cast<double>(background[1][i] / background[0][i]);
      dark[sun ? 1 : 0] += ratio < 0.8 ? 1 : 0;
      changed[sun ? 1 : 0] += std::abs(ratio - 1) > 0.2 ? 1 : 0;
    }
  }
  EXPECT_GT(dark[1], 20);
  EXPECT_EQ(dark[0], 0);
  EXPECT_LT(changed[1], 48 * 48 / 3);
}

// The world may be turned: land, its objects, the bow and the sun.
TEST(LandObjectsView, TurningTheWorldChangesNothing) {
  const Height hills = [](double x, double y) {
    return 3 * std::sin(x / 40) + 2 * std::cos(y / 55) + 0.03 * x - 0.02 * y;
  };
  ViewResult view[2];
  for (int turn = 0; turn < 2; ++turn) {
    Scene scene = scene_on(20, 700, true);
    const auto bare =
        land_of([&](double x, double y) { return turn == 0 ? hills(x, y) : hills(y, -x); }, 600, 4);
    std::vector<ObjectPlace> houses, trees;
    for (int i = 0; i < 40; ++i) {
      const double x = 12 + 7 * i, y = 60 * std::sin(3.7 * i), heading_deg = 25 * i;
      // x' = -y, y' = x: a quarter to the left.
      const ObjectPlace place = turn == 0 ? ObjectPlace{x, y, heading_deg, 1, 0}
                                          : ObjectPlace{-y, x, heading_deg - 90, 1, 0};
      (i % 2 == 0 ? houses : trees).push_back(place);
    }
    auto land = std::make_shared<LandScene>(
        *with_objects(bare, {{block(8, 6, 5), houses}, {generated("sphere", 200, 3), trees}}));
    land->heading_deg = turn == 0 ? 30 : -60;
    view[turn] = view_of(scene, land);
  }
  for (std::size_t row = 0; row < 2; ++row) {
    const SignatureResult &a = view[0].row[row], &b = view[1].row[row];
    const auto same = [](const Estimate& x, const Estimate& y, double of) {
      EXPECT_LT(std::abs(x.value - y.value), 4 * std::hypot(x.stderr_, y.stderr_) + 1e-4 * of);
    };
    same(a.intensity_w_sr, b.intensity_w_sr, a.intensity_w_sr.value);
    same(a.contrast_intensity_w_sr, b.contrast_intensity_w_sr, a.apparent_intensity_w_sr.value);
    same(a.background_radiance_w_m2_sr, b.background_radiance_w_m2_sr,
         a.background_radiance_w_m2_sr.value);
    EXPECT_NEAR(a.clutter->clutter_sigma_w_m2_sr.value, b.clutter->clutter_sigma_w_m2_sr.value,
                0.05 * a.clutter->clutter_sigma_w_m2_sr.value);
  }
}

// Black land, black objects and air of one temperature: nobody can tell where an object stands.
TEST(LandObjectsView, BlackObjectsOfTheLandsTemperatureAreNotSeen) {
  Scene scene = scene_on(12, 800, false, 290);
  SceneSpec spec = scene_of(generated("box", 300, 0, 4, 3, 2), grey(0.6), lwir());
  spec.band.push_back({"MWIR", 3.2, 5, 0.25, {}});
  spec.spectral_breaks_um = air_band_edges_um(3, 13);
  spec.land_material = {grey(1)};
  scene.simulator = simulator_of(spec);
  const auto land = land_of(flat, 5000, 20);
  std::vector<ObjectPlace> place;
  for (int i = 0; i < 60; ++i)
    place.push_back({-15 - 4.0 * i, 50 * std::sin(2.9 * i), 20.0 * i, 1, 0});
  const ViewResult bare = view_of(scene, land),
                   built = view_of(scene, with_objects(land, {{block(8, 6, 5), place}}));
  for (std::size_t i = 0; i < 2; ++i) {
    const SignatureResult& r = built.row[i];
    const double black = i == 0 ? planck_band_radiance_w_m2_sr(8, 12, 290)
                                : planck_band_radiance_w_m2_sr(3.2, 5, 290);
    // The land's air and quadrature take a thousandth.
    EXPECT_NEAR(r.background_radiance_w_m2_sr.value, bare.row[i].background_radiance_w_m2_sr.value,
                2e-5 * black);
    EXPECT_NEAR(r.clutter->clutter_mean_w_m2_sr.value,
                bare.row[i].clutter->clutter_mean_w_m2_sr.value, 2e-5 * black);
    EXPECT_LT(r.clutter->clutter_sigma_w_m2_sr.value, 2e-4 * black);
    // Objects hide a part of the sky, which is colder, from the target.
    EXPECT_GE(r.intensity_w_sr.value, bare.row[i].intensity_w_sr.value);
  }
}

// An object of a material of its own, hot: it stands behind the target, is mirrored in it, and has
// its fraction of the clutter's window.
TEST(LandObjectsView, AHotWallIsBehindTheTargetAndInIt) {
  Scene scene = scene_on(8, 900, false);
  SceneSpec spec = scene_of(generated("box", 300, 0, 4, 3, 2), grey(0.6), lwir());
  spec.band.push_back({"MWIR", 3.2, 5, 0.25, {}});
  spec.spectral_breaks_um = air_band_edges_um(3, 13);
  spec.land_material = {grey(kEmissivity), grey(1)};
  scene.simulator = simulator_of(spec);
  scene.request.condition[0].land_temperature_k = {kGroundK, 400};
  const auto ground = land_of(flat, 300, 10);
  const auto bare = std::make_shared<LandScene>(*ground);
  auto cover = LandCover::create(std::vector<CoverLayer>{{"ground"}, {"wall", std::nullopt, true}},
                                 *ground->field, {});
  ASSERT_TRUE(cover.ok()) << cover.status();
  bare->cover = *std::move(cover);
  const auto walled = [&](double azimuth_deg) {
    return with_objects(bare, {{block(2, 24, 14), {at_azimuth(azimuth_deg, 8)}}}, 1);
  };
  const ViewResult open = view_of(scene, bare), behind = view_of(scene, walled(kSensorDeg + 180)),
                   beside = view_of(scene, walled(kSensorDeg + 70));
  for (std::size_t i = 0; i < 2; ++i) {
    const double hot = i == 0 ? planck_band_radiance_w_m2_sr(8, 12, 400)
                              : planck_band_radiance_w_m2_sr(3.2, 5, 400);
    const SignatureResult& r = behind.row[i];
    EXPECT_LT(open.row[i].background_radiance_w_m2_sr.value, 0.5 * hot);
    EXPECT_GT(r.background_radiance_w_m2_sr.value, 0.5 * hot);
    EXPECT_LT(r.background_radiance_w_m2_sr.value, 1.001 * hot);
    EXPECT_GT(r.clutter->material_fraction.at(1), 0.1);
    EXPECT_EQ(open.row[i].clutter->material_fraction.at(1), 0);
    EXPECT_LT(r.contrast_intensity_w_sr.value, open.row[i].contrast_intensity_w_sr.value);
    // Beside the target it shines on a face that the sensor sees.
    EXPECT_GT(beside.row[i].intensity_w_sr.value, 1.02 * open.row[i].intensity_w_sr.value);
  }
}

// An object around the sensor or the target is refused.
TEST(LandObjectsView, ObjectsAroundTheSensorOrTheTargetAreRefused) {
  Scene scene = scene_on(5, 100, false);
  const auto land = land_of(flat, 300, 10);
  scene.request.land = with_objects(land, {{block(20, 20, 30), {at_azimuth(kSensorDeg, 100)}}});
  const absl::Status status = scene.simulator->simulate(scene.request).status();
  EXPECT_NE(status.message().find("lies inside an object on the land (land.object[0].place[0])"),
            std::string::npos)
      << status;
}

}  // namespace
}  // namespace irsig
