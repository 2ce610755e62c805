// Rationale: a picture has paths of its own, the same number in each pixel, so that no pixel inside
// the silhouette is empty or too bright, however few paths the row itself takes. Expected: a black
// sphere of one temperature has its radiance in every inner pixel, within the rounding of float; a
// picture adds up to its row's intensity within the errors of both; the row does not change with
// the picture; parts fill the pixels that they are seen in; a pixel's standard error is the scatter
// of pictures of other seeds, inside and on edges. Source: closed forms; the row.
#include <algorithm>
#include <cmath>
#include <map>

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
  double variance = 0;
  for (const float stderr_w_m2_sr : row.image_stderr_w_m2_sr)
    variance +=
        std::pow(static_cast<double>(stderr_w_m2_sr) * std::pow(view->pixel_rad * kFarM, 2), 2);
  const double error = std::hypot(std::sqrt(variance), row.intensity_w_sr.stderr_);
  EXPECT_NEAR(sum_w_sr(*view), row.intensity_w_sr.value, 3 * error);
  EXPECT_LT(error, 0.02 * row.intensity_w_sr.value);
}

// A block before a wall: each fills what it hides nobody can see of the other.
TEST(Picture, PartsFillThePixelsThatTheyAreSeenIn) {
  const Mesh mesh = joined(generated("box", 12, 0, 1, 4, 3),
                           moved(generated("box", 12, 0, 0.2, 1.3, 0.7), {5, 0.4, 0.2}), "block_");
  SceneSpec scene = scene_of(mesh, grey(1), lwir());
  scene.part = {{"block", {"block_*"}, 0, false, false}, {"wall", {}, 0, false, false, true}};
  const auto simulator = simulator_of(scene);
  for (const std::uint32_t px : {1u, 7u, 100u}) {
    const ViewResult view = simulated(*simulator, request(*simulator, 0, 0, kFarM, {300, 300}), px);
    std::map<std::uint32_t, double> samples;
    std::uint64_t before = 0;
    std::map<std::uint32_t, std::uint32_t> of_pixel;
    for (const TracedPictures::Met& met : view.seen) {
      EXPECT_TRUE(samples.empty() || before < std::uint64_t{met.pixel} * 2 + met.part);
      before = std::uint64_t{met.pixel} * 2 + met.part;
      EXPECT_LT(met.pixel, view.image_width_px * view.image_height_px);
      EXPECT_LE(of_pixel[met.pixel] += met.samples, view.pixel_samples);
      samples[met.part] += met.samples;
    }
    const double pixel_m2 = std::pow(view.pixel_rad * kFarM, 2);
    EXPECT_NEAR(samples[0] / view.pixel_samples * pixel_m2, 1.3 * 0.7, 0.005 * 1.3 * 0.7) << px;
    EXPECT_NEAR(samples[1] / view.pixel_samples * pixel_m2, 12 - 1.3 * 0.7, 0.005 * 12) << px;
  }
}

// Scatter of the pixels of one kind, over all that a test of seeds compares.
struct Scatter {
  double squares = 0, pixels = 0, within = 0;
  [[nodiscard]] double rms() const { return std::sqrt(squares / pixels); }
};

// Sun, sky, sea, a hot part and shadows, each of its own scatter.
TEST(Picture, ErrorsAreTheScatterOfOtherSeeds) {
  constexpr int kSeeds = 24;
  const auto simulator = simulator_of(painted_frigate());
  ViewRequest r = request(*simulator, 60, 30, 5000, {400, 300});
  make_day(r.condition[0]);
  r.max_reflections = 3;
  std::vector<ViewResult> view;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    r.seed = static_cast<std::uint64_t>(seed);
    view.push_back(simulated(*simulator, r, 96));
  }
  const std::size_t pixels = view[0].row[0].image_w_m2_sr.size();
  std::vector<double> filled(pixels, 0);
  for (const ViewResult& v : view)
    for (const TracedPictures::Met& met : v.seen)
      filled[met.pixel] += met.samples / (static_cast<double>(v.pixel_samples) * kSeeds);
  for (std::size_t row = 0; row < 2; ++row) {
    Scatter inside, edge;
    for (std::size_t i = 0; i < pixels; ++i) {
      if (filled[i] == 0) continue;
      double mean = 0;
      for (const ViewResult& v : view)
        mean += static_cast<double>(v.row[row].image_w_m2_sr[i]) / kSeeds;
      for (const ViewResult& v : view) {
        const double z = (static_cast<double>(v.row[row].image_w_m2_sr[i]) - mean) /
                         static_cast<double>(v.row[row].image_stderr_w_m2_sr[i]) *
                         std::sqrt(kSeeds / (kSeeds - 1.0));
        Scatter& of = filled[i] > 1 - 1e-9 ? inside : edge;
        of.squares += z * z;
        of.pixels += 1;
        of.within += std::abs(z) < 1.96 ? 1 : 0;
      }
    }
    std::printf("band %zu: inside rms z %.3f, %.4f within 1.96; edges %.3f, %.4f\n", row,
                inside.rms(), inside.within / inside.pixels, edge.rms(), edge.within / edge.pixels);
    for (const Scatter& of : {inside, edge}) {
      EXPECT_GT(of.rms(), 0.7);
      EXPECT_LT(of.rms(), 1.25);
      EXPECT_GT(of.within / of.pixels, 0.93);
    }
  }
}

}  // namespace
}  // namespace irsig
