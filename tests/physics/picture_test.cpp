// Rationale: a picture has paths of its own, the same number in each pixel, so that no pixel inside
// the silhouette is empty or too bright, however few paths the row itself takes. Expected: a black
// sphere of one temperature has its radiance in every inner pixel, within the rounding of float; a
// picture adds up to its row's intensity within the errors of both; the row does not change with
// the picture. Source: closed forms; the row.
#include <algorithm>
#include <cmath>

#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kFarM = 1e5;

ViewResult simulated(const Simulator& simulator, ViewRequest r, std::uint32_t px) {
  r.thumbnail_px = px;
  r.accuracy.samples_per_replicate = 16;  // one path for ten pixels
  auto view = simulator.simulate(r);
  EXPECT_TRUE(view.ok()) << view.status();
  return *std::move(view);
}

double sum_w_sr(const ViewResult& view) {
  double sum = 0;
  for (const float pixel : view.row[0].image_w_m2_sr) sum += static_cast<double>(pixel);
  return sum * std::pow(view.pixel_rad * kFarM, 2);
}

TEST(Picture, InnerPixelsHaveTheRadianceOfABlackSphere) {
  const auto simulator = simulator_of(scene_of(generated("sphere", 5000, 1), grey(1), lwir()));
  const ViewResult view = simulated(*simulator, request(*simulator, 30, 20, kFarM, {300}), 64);
  const SignatureResult& row = view.row[0];
  const double radiance = row.intensity_w_sr.value / row.projected_area_m2.value;
  int inner = 0;
  for (std::uint32_t v = 0; v < view.image_height_px; ++v)
    for (std::uint32_t u = 0; u < view.image_width_px; ++u) {
      const double x = 2 * (u + 0.5) / view.image_width_px - 1,
                   y = 2 * (v + 0.5) / view.image_height_px - 1;
      const double pixel = row.image_w_m2_sr[v * view.image_width_px + u];
      EXPECT_LE(pixel, 1.0001 * radiance) << u << ", " << v;
      if (std::hypot(x, y) > 1.1) {
        EXPECT_EQ(pixel, 0) << u << ", " << v;
      }
      if (std::hypot(x, y) > 0.9) continue;
      ++inner;
      EXPECT_NEAR(pixel, radiance, 1e-4 * radiance) << u << ", " << v;
    }
  EXPECT_GT(inner, 2000);
  EXPECT_NEAR(sum_w_sr(view), radiance * 3.14159265, 0.01 * radiance * 3.14159265);
}

TEST(Picture, OfFewPixelsAddsUp) {
  const auto simulator = simulator_of(scene_of(generated("sphere", 5000, 1), grey(1), lwir()));
  for (const std::uint32_t px : {1u, 2u, 3u, 5u}) {
    ViewRequest r = request(*simulator, 30, 20, kFarM, {300});
    r.thumbnail_px = px;
    r.accuracy.samples_per_replicate = 4096;
    const auto view = simulator->simulate(r);
    ASSERT_TRUE(view.ok()) << view.status();
    const double whole = view->row[0].intensity_w_sr.value;
    EXPECT_NEAR(sum_w_sr(*view), whole, 0.01 * whole) << px;
  }
}

// Sky and other parts are reflected, a small hot part has a stratum of its own in the row.
TEST(Picture, AddsUpToARowWithReflectionsAndAHotPart) {
  Mesh mesh = joined(generated("box", 12, 0, 4, 2, 1),
                     moved(generated("box", 12, 0, 0.2, 0.2, 0.2), {0, 0, -0.61}), "hot_");
  SceneSpec scene = scene_of(mesh, grey(0.6), mwir());
  scene.part = {{"hot", {"hot_*"}, 0, false, true}, {"body", {}, 0, false, false, true}};
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 50, 25, kFarM, {700, 300});
  r.condition[0].surroundings = {SurroundingsKind::kSea, 260, 0, 290, 0.96, 0};
  r.max_reflections = 3;
  r.accuracy.samples_per_replicate = 4096;
  const auto bare = simulator->simulate(r);
  ASSERT_TRUE(bare.ok());
  r.thumbnail_px = 96;
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok());
  const SignatureResult& row = view->row[0];
  EXPECT_EQ(row.intensity_w_sr.value, bare->row[0].intensity_w_sr.value);
  EXPECT_EQ(row.numerical_error_w_sr, bare->row[0].numerical_error_w_sr);
  EXPECT_GT(view->rays, bare->rays) << "its rays are counted";
  // Pixels are nearly square: their height is that of the width within half a pixel in all.
  const double squares = 0.5 / view->image_height_px;
  EXPECT_NEAR(sum_w_sr(*view), row.intensity_w_sr.value,
              (squares + 0.01) * row.intensity_w_sr.value);
}

}  // namespace
}  // namespace irsig
