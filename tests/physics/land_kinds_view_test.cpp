// Views of land whose temperatures are computed: by kinds.
#include <cmath>

#include "land_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

// One material whose temperature is computed, under a free horizon.
std::shared_ptr<const LandKinds> kinds_of_one() {
  auto out = std::make_shared<LandKinds>();
  out->materials = 1;
  out->computed = {true};
  out->on_objects = {false};
  out->horizon.resize(1);
  out->index_kinds();
  return out;
}

double height(double x, double y) { return 0.1 * x + 0.22 * y; }

ViewResult view_of_slope(std::shared_ptr<const LandKinds> kinds, std::vector<double> kelvin,
                         std::vector<double> error_k = {}) {
  Scene scene = scene_on(50, 800, true);
  auto land = std::make_shared<LandScene>(*land_of(height, 1000, 10));
  land->kinds = std::move(kinds);
  scene.request.condition[0].land_temperature_k = std::move(kelvin);
  scene.request.condition[0].land_temperature_error_k = std::move(error_k);
  return view_of(scene, land);
}

// Rationale: radiance is linear in what a place is made of. Expected: the background of a slope is
// the mean of those of its kinds' temperatures, with their shares; but the land that it faces is as
// warm as the level kind.
TEST(LandKindsView, ASlopeIsTheMeanOfItsKinds) {
  const auto kinds = kinds_of_one();
  std::vector<double> kelvin(kinds->kind.size());
  for (std::size_t k = 0; k < kelvin.size(); ++k) kelvin[k] = 280 + 4 * static_cast<double>(k);
  const ViewResult mixed = view_of_slope(kinds, kelvin);
  std::vector<KindShare> mix;
  kinds->at(0, 0, normalized(Vec<Enu>{-0.1, -0.22, 1}), false, 1, mix);
  ASSERT_EQ(mix.size(), 3u);
  const double open = 0.5 + 0.5 / std::hypot(1, 0.1, 0.22), faces = 1 - open,
               share_of_faced = faces / (open * kEmissivity + faces);
  for (std::size_t row = 0; row < 2; ++row) {
    const double level =
        view_of_slope(nullptr, {kelvin[0]}).row[row].background_radiance_w_m2_sr.value;
    double expected = 0;
    for (const KindShare& part : mix)
      expected +=
          static_cast<double>(part.share) *
          view_of_slope(nullptr, {kelvin[part.kind]}).row[row].background_radiance_w_m2_sr.value;
    expected += share_of_faced * (level - expected);
    const SignatureResult& r = mixed.row[row];
    EXPECT_NEAR(r.background_radiance_w_m2_sr.value, expected, 1e-4 * expected);
    EXPECT_NEAR(r.clutter->clutter_mean_w_m2_sr.value, expected, 2e-3 * expected);
    EXPECT_NEAR(r.clutter->material_fraction[0], 1, 1e-5);
  }
}

// Rationale: kinds of one temperature are one land. Expected: the same rows, to rounding.
TEST(LandKindsView, KindsOfOneTemperatureAreOneLand) {
  const auto kinds = kinds_of_one();
  const ViewResult a = view_of_slope(kinds, std::vector<double>(kinds->kind.size(), 301.5)),
                   b = view_of_slope(nullptr, {301.5});
  for (std::size_t row = 0; row < 2; ++row) {
    EXPECT_NEAR(a.row[row].intensity_w_sr.value, b.row[row].intensity_w_sr.value,
                1e-5 * b.row[row].intensity_w_sr.value);
    EXPECT_NEAR(a.row[row].contrast_intensity_w_sr.value, b.row[row].contrast_intensity_w_sr.value,
                1e-5 * b.row[row].apparent_intensity_w_sr.value);
  }
}

// Rationale: what temperatures are not sure of is an error of the row. Expected: by how much the
// row changes if all of land is warmer by its error; nothing where it is stated.
TEST(LandKindsView, ErrorsOfTemperaturesAreErrorsOfRows) {
  constexpr double kErrorK = 4;
  const auto kinds = kinds_of_one();
  const std::size_t n = kinds->kind.size();
  const ViewResult stated = view_of_slope(kinds, std::vector<double>(n, 295)),
                   warmer = view_of_slope(kinds, std::vector<double>(n, 295 + kErrorK)),
                   unsure = view_of_slope(kinds, std::vector<double>(n, 295),
                                          std::vector<double>(n, kErrorK));
  for (std::size_t row = 0; row < 2; ++row) {
    const SignatureResult &s = stated.row[row], &w = warmer.row[row], &u = unsure.row[row];
    EXPECT_EQ(s.temperature_bound_w_sr, 0);
    EXPECT_EQ(s.background_bound_w_sr, 0);
    EXPECT_EQ(u.intensity_w_sr.value, s.intensity_w_sr.value);
    const double source = w.intensity_w_sr.value - s.intensity_w_sr.value;
    EXPECT_GT(source, 0);
    EXPECT_NEAR(u.temperature_bound_w_sr, source, 0.02 * source);
    // Land behind the target changes the contrast the other way than land that it reflects; errors
    // add up.
    const double seen = w.apparent_intensity_w_sr.value - s.apparent_intensity_w_sr.value,
                 contrast = w.contrast_intensity_w_sr.value - s.contrast_intensity_w_sr.value,
                 bound = std::sqrt(3 * (std::pow(u.contrast_numerical_error_w_sr, 2) -
                                        std::pow(s.contrast_numerical_error_w_sr, 2)));
    const double apparent = std::sqrt(3 * (std::pow(u.apparent_numerical_error_w_sr, 2) -
                                           std::pow(s.apparent_numerical_error_w_sr, 2)));
    EXPECT_GT(apparent, 0.95 * seen);
    EXPECT_LT(apparent, 1.3 * seen);
    EXPECT_LT(contrast, 0);
    EXPECT_NEAR(bound, 2 * seen - contrast, 0.05 * (2 * seen - contrast));
  }
}

// Rationale: each kind has an error of its own, and the level kind's is also that of the land that
// slopes face. Expected: by how much the row changes if that kind alone is warmer.
TEST(LandKindsView, AnErrorIsThatOfItsKind) {
  constexpr double kErrorK = 4;
  const auto kinds = kinds_of_one();
  const std::size_t n = kinds->kind.size();
  const ViewResult stated = view_of_slope(kinds, std::vector<double>(n, 295));
  double all[2] = {0, 0};
  for (std::size_t k = 0; k < n; ++k) {
    std::vector<double> kelvin(n, 295), error_k(n, 0);
    kelvin[k] += kErrorK;
    error_k[k] = kErrorK;
    const ViewResult warmer = view_of_slope(kinds, kelvin),
                     unsure = view_of_slope(kinds, std::vector<double>(n, 295), error_k);
    for (std::size_t row = 0; row < 2; ++row) {
      const double source =
          warmer.row[row].intensity_w_sr.value - stated.row[row].intensity_w_sr.value;
      EXPECT_NEAR(unsure.row[row].temperature_bound_w_sr, source,
                  0.02 * source + 1e-6 * stated.row[row].intensity_w_sr.value)
          << k;
      all[row] += source;
    }
  }
  EXPECT_GT(all[0], 0);
  EXPECT_GT(all[1], 0);
}

// Rationale: pixels of land have its temperature and its error. Expected beside the target: the
// mean of the kinds' temperatures; and an error by how much the pixel changes if all of land is
// warmer.
TEST(LandKindsView, PixelsHaveTemperaturesAndTheirErrors) {
  constexpr double kErrorK = 4;
  const auto kinds = kinds_of_one();
  std::vector<double> kelvin(kinds->kind.size()), warm;
  for (std::size_t k = 0; k < kelvin.size(); ++k) kelvin[k] = 280 + 4 * static_cast<double>(k);
  for (const double k : kelvin) warm.push_back(k + kErrorK);
  const auto picture_of = [&](const std::vector<double>& of, std::vector<double> error_k,
                              double elevation_deg = 50) {
    Scene scene = scene_on(elevation_deg, 800, true);
    ImageSpec image;
    image.width_px = image.height_px = 16;
    image.margin = 3;
    image.layer = {ImageLayer::kAtSensor, ImageLayer::kLandTemperature};
    scene.request.image = image;
    auto land = std::make_shared<LandScene>(elevation_deg < 10 ? *land_of(flat, 6000, 50)
                                                               : *land_of(height, 1000, 10));
    land->kinds = kinds;
    scene.request.condition[0].land_temperature_k = of;
    scene.request.condition[0].land_temperature_error_k = std::move(error_k);
    return view_of(scene, land).row[0];
  };
  const SignatureResult stated = picture_of(kelvin, {}), warmer = picture_of(warm, {}),
                        unsure = picture_of(kelvin, std::vector<double>(kelvin.size(), kErrorK));
  std::vector<KindShare> mix;
  kinds->at(0, 0, normalized(Vec<Enu>{-0.1, -0.22, 1}), false, 1, mix);
  double mean_k = 0;
  for (const KindShare& part : mix) mean_k += static_cast<double>(part.share) * kelvin[part.kind];
  ASSERT_EQ(stated.layer.size(), 2u);
  const std::size_t at = stated.layer[0].layer == ImageLayer::kAtSensor ? 0 : 1;
  for (const std::size_t pixel : {0u, 15u, 16u * 15, 16u * 16 - 1}) {  // the corners
    EXPECT_NEAR(stated.layer[1 - at].value[pixel], mean_k, 0.1);
    const double change =
        static_cast<double>(warmer.layer[at].value[pixel] - stated.layer[at].value[pixel]);
    EXPECT_GT(change, 0);
    EXPECT_NEAR(unsure.layer[at].stderr_[pixel] - stated.layer[at].stderr_[pixel], change,
                0.05 * change);
  }
  // At grazing incidence level land far behind the target is seen, with the air in front of it.
  const SignatureResult far = picture_of(kelvin, {}, 4), far_warmer = picture_of(warm, {}, 4),
                        far_unsure =
                            picture_of(kelvin, std::vector<double>(kelvin.size(), kErrorK), 4);
  double changed = 0, error = 0;
  for (std::size_t pixel = 0; pixel < 16; ++pixel) {  // the upper row
    changed += static_cast<double>(far_warmer.layer[at].value[pixel] - far.layer[at].value[pixel]);
    error +=
        static_cast<double>(far_unsure.layer[at].stderr_[pixel] - far.layer[at].stderr_[pixel]);
  }
  ASSERT_GT(changed, 0);
  EXPECT_NEAR(error, changed, 0.05 * changed);
}

}  // namespace
}  // namespace irsig
