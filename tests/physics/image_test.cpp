// Rationale: an image of its own frame, accuracy and layers shows what a sensor would see: where
// the target stands, how far it is, what it emits and reflects, and what stands beside it. Expected
// where everything has one temperature: the target cannot be seen. Layers add up. The image with
// the target less the one without adds up to the row's contrast, also for targets far below a
// pixel. Errors are as small as they are asked to be, and true. Source: closed forms; the row.
#include <cmath>
#include <map>
#include <numbers>

#include "core/signature/view/pixel_background.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

const std::vector<ImageLayer> kAll = {
    ImageLayer::kEmitted,  ImageLayer::kSun,         ImageLayer::kSky,        ImageLayer::kSurface,
    ImageLayer::kParts,    ImageLayer::kPath,        ImageLayer::kBackground, ImageLayer::kHidden,
    ImageLayer::kAtSensor, ImageLayer::kTemperature, ImageLayer::kRange,      ImageLayer::kNormalX,
    ImageLayer::kNormalY,  ImageLayer::kNormalZ,     ImageLayer::kSunlit};

ImageSpec framed(std::uint32_t width_px, std::uint32_t height_px, double margin = 0.05) {
  ImageSpec out;
  out.width_px = width_px;
  out.height_px = height_px;
  out.margin = margin;
  out.layer = kAll;
  return out;
}

ImageSpec camera(std::uint32_t width_px, std::uint32_t height_px, double field_of_view_rad) {
  ImageSpec out = framed(width_px, height_px);
  out.camera.emplace().field_of_view_rad = field_of_view_rad;
  return out;
}

ViewResult simulated(const Simulator& simulator, const ViewRequest& r) {
  auto view = simulator.simulate(r);
  EXPECT_TRUE(view.ok()) << view.status();
  return *std::move(view);
}

const std::vector<float>& values(const SignatureResult& row, ImageLayer layer) {
  for (const LayerImage& image : row.layer)
    if (image.layer == layer) return image.value;
  ADD_FAILURE() << "no layer " << name_of(layer);
  return row.image_w_m2_sr;
}

double at(const SignatureResult& row, ImageLayer layer, std::size_t pixel) {
  return static_cast<double>(values(row, layer)[pixel]);
}

// A ship by day above a sea of another temperature, in grey air.
struct Day {
  SceneSpec scene;
  ViewRequest request;
};
Day day(double elevation_deg = 10) {
  Day out;
  out.scene = painted_frigate();
  const auto simulator = simulator_of(out.scene);
  out.request = request(*simulator, 60, elevation_deg, 2000, {400, 300});
  ConditionSpec& c = out.request.condition[0];
  make_day(c);
  c.air_temperature_k = 285;
  c.above_surface_m = 10;
  out.request.air = {AirModel::kHomogeneous, 1e-4, 101325, 287, true};
  out.request.max_reflections = 3;
  return out;
}

TEST(Image, LayersAddUp) {
  Day d = day();
  d.request.image = framed(80, 50);
  const auto simulator = simulator_of(d.scene);
  for (const SignatureResult& row : simulated(*simulator, d.request).row) {
    const double brightest = *std::max_element(row.image_w_m2_sr.begin(), row.image_w_m2_sr.end());
    double hidden = 0;
    for (std::size_t i = 0; i < row.image_w_m2_sr.size(); ++i) {
      double sum = -at(row, ImageLayer::kHidden, i);
      for (std::size_t layer = 0; layer <= static_cast<std::size_t>(ImageLayer::kBackground);
           ++layer)
        sum += at(row, kAll[layer], i);
      EXPECT_NEAR(sum, at(row, ImageLayer::kAtSensor, i), 1e-6 * brightest) << i;
      hidden += at(row, ImageLayer::kHidden, i);
    }
    EXPECT_GT(hidden, 0);
  }
  // Without the light that a sensor sees, layers are at the target.
  std::erase_if(d.request.image->layer,
                [](ImageLayer l) { return l > ImageLayer::kParts && l != ImageLayer::kRange; });
  for (const SignatureResult& row : simulated(*simulator, d.request).row)
    for (std::size_t i = 0; i < row.image_w_m2_sr.size(); ++i) {
      double sum = 0;
      for (std::size_t layer = 0; layer <= static_cast<std::size_t>(ImageLayer::kParts); ++layer)
        sum += at(row, kAll[layer], i);
      const auto pixel = static_cast<double>(row.image_w_m2_sr[i]);
      EXPECT_NEAR(sum, pixel, 1e-6 * pixel) << i;
    }
}

TEST(Image, ShowsNothingWhereAllHasOneTemperature) {
  Day d = day(1.0);
  ConditionSpec& c = d.request.condition[0];
  c.part_temperature_k = {290, 290};
  c.surroundings = {SurroundingsKind::kSea, 290, 0, 290, 1, 0};
  c.sun = false;
  c.air_temperature_k = 290;
  d.request.max_reflections = 64;
  d.request.image = camera(64, 48, 0.3);
  d.request.image->samples = 64;
  const auto simulator = simulator_of(d.scene);
  const ViewResult view = simulated(*simulator, d.request);
  ASSERT_FALSE(view.seen.empty());
  for (const SignatureResult& row : view.row) {
    const LayerImage& seen = row.layer[static_cast<std::size_t>(ImageLayer::kAtSensor)];
    const auto black = static_cast<double>(seen.value.front());  // beside the target
    int outside = 0;
    for (std::size_t i = 0; i < seen.value.size(); ++i) {
      const double off = static_cast<double>(seen.value[i]) - black;
      EXPECT_LT(std::abs(off), 0.02 * black) << i;
      outside += std::abs(off) > 3 * static_cast<double>(seen.stderr_[i]) + 1e-6 * black;
    }
    EXPECT_LT(outside, 0.02 * static_cast<double>(seen.value.size()));
    EXPECT_NEAR(row.contrast_intensity_w_sr.value, 0, 4 * row.contrast_numerical_error_w_sr);
  }
}

// Tests targets from one that fills most of the picture to one of 0.03 pixels; before the horizon,
// too.
TEST(Image, WithLessWithoutTheTargetIsItsContrast) {
  for (const double elevation_deg : {-0.1, 0.2, 10.0})
    for (const double margin : {0.02, 5.0, 60.0}) {
      Day d = day(elevation_deg);
      d.request.accuracy.samples_per_replicate = 1u << 13;
      d.request.image = framed(48, 32, margin);
      if (margin < 1) d.request.image->samples = 64;
      const auto simulator = simulator_of(d.scene);
      const ViewResult view = simulated(*simulator, d.request);
      for (const SignatureResult& row : view.row) {
        double sum = 0, square = 0;
        const LayerImage& seen = row.layer[static_cast<std::size_t>(ImageLayer::kAtSensor)];
        const double of_pixel = std::pow(view.pixel_rad * d.request.viewpoint.range_m, 2);
        for (std::size_t i = 0; i < seen.value.size(); ++i) {
          const double x = (static_cast<double>(i % 48) - 23.5) * view.pixel_rad,
                       y = (static_cast<double>(i / 48) - 15.5) * view.pixel_rad;
          const double m2 = of_pixel * std::pow(1 + x * x + y * y, -1.5);
          sum += m2 * (static_cast<double>(seen.value[i]) - at(row, ImageLayer::kPath, i) -
                       at(row, ImageLayer::kBackground, i));
          // float32 of what is seen
          square += std::pow(m2 * std::max(static_cast<double>(seen.stderr_[i]),
                                           6e-8 * static_cast<double>(seen.value[i])),
                             2);
        }
        const double error = std::hypot(std::sqrt(square), row.contrast_intensity_w_sr.stderr_);
        EXPECT_NEAR(sum, row.contrast_intensity_w_sr.value, 4 * error)
            << elevation_deg << " deg, " << margin << ", band " << row.band;
        EXPECT_LT(error, 0.05 * std::abs(row.contrast_intensity_w_sr.value) +
                             0.005 * row.intensity_w_sr.value);
      }
    }
}

// Eight rays of a pixel would have missed it: an image of nothing, with an error of nothing.
TEST(Image, TargetsFarBelowAPixelAreMet) {
  const auto simulator =
      simulator_of(scene_of(generated("box", 12, 0, 0.02, 1, 1), grey(1), lwir()));
  for (const double pixel_m : {30.0, 1e3, 1e4})
    for (const std::uint64_t seed : {1, 2, 3}) {
      ViewRequest r = request(*simulator, 0, 0, 1e6, {300});
      r.seed = seed;
      r.image = camera(5, 5, 2 * std::atan(2.5 * pixel_m / 1e6));
      r.image->layer = {ImageLayer::kTemperature, ImageLayer::kRange};
      r.image->samples = 8;
      const ViewResult view = simulated(*simulator, r);
      ASSERT_FALSE(view.seen.empty());
      for (const TracedPictures::Met& met : view.seen) {
        EXPECT_NEAR(at(view.row[0], ImageLayer::kTemperature, met.pixel), 300, 1e-3) << pixel_m;
        EXPECT_NEAR(at(view.row[0], ImageLayer::kRange, met.pixel), 1e6, 1) << pixel_m;
      }
      double sum = 0, square = 0;
      for (std::size_t i = 0; i < 25; ++i) {
        sum += static_cast<double>(view.row[0].image_w_m2_sr[i]);
        square += std::pow(static_cast<double>(view.row[0].image_stderr_w_m2_sr[i]), 2);
      }
      const double m2 = std::pow(view.pixel_rad * 1e6, 2), whole = view.row[0].intensity_w_sr.value;
      EXPECT_NEAR(m2 * sum, whole, 0.01 * whole) << pixel_m;
      EXPECT_NEAR(m2 * sum, whole, 5 * m2 * std::sqrt(square) + 1e-4 * whole) << pixel_m;
    }
}

// A plate before the axis: where it is in the picture, how far, and how warm.
TEST(Image, CamerasShowThePlaceTheRangeAndTheTemperature) {
  SceneSpec scene =
      scene_of(moved(generated("box", 12, 0, 0.02, 4, 2), {0, 10, -5}), grey(0.9), lwir());
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 0, 0, 1000, {320});
  r.image = camera(200, 100, 0.04);
  const ViewResult view = simulated(*simulator, r);
  const SignatureResult& row = view.row[0];
  EXPECT_NEAR(view.pixel_rad, 2 * std::tan(0.02) / 200, 1e-9);
  double pixels = 0, x = 0, y = 0;
  for (const TracedPictures::Met& met : view.seen) {
    const double part = static_cast<double>(met.samples) / view.pixel_samples;
    pixels += part;
    x += part * (met.pixel % 200 + 0.5 - 100);
    y += part * (50 - met.pixel / 200 - 0.5);
    EXPECT_NEAR(at(row, ImageLayer::kTemperature, met.pixel), 320, 1e-3);
    EXPECT_NEAR(at(row, ImageLayer::kRange, met.pixel), std::hypot(999.99, 10, 5), 0.03);
  }
  const double m = view.pixel_rad * 999.99;
  EXPECT_NEAR(pixels * m * m, 8, 0.02);
  // Looking aft from ahead, starboard is to the left.
  EXPECT_NEAR(x / pixels * m, -10, 0.02);
  EXPECT_NEAR(y / pixels * m, 5, 0.02);

  r.image->camera->look_at_m = Vec<Body>{0, 10, -5};
  const ViewResult middle = simulated(*simulator, r);
  double left = 0, all = 0;
  for (const TracedPictures::Met& met : middle.seen) {
    all += met.samples;
    left += met.samples * (met.pixel % 200 + 0.5 - 100);
  }
  EXPECT_NEAR(left / all * m, 0, 0.02);
  EXPECT_NEAR(all / middle.pixel_samples, pixels, 0.5);

  // Beside it: an empty picture.
  r.image->camera->look_at_m = Vec<Body>{0, -500, 0};
  const ViewResult empty = simulated(*simulator, r);
  EXPECT_TRUE(empty.seen.empty());
  EXPECT_EQ(empty.row[0].image_error_relative, 0);
  EXPECT_EQ(empty.row[0].intensity_w_sr.value, row.intensity_w_sr.value);

  r.image->camera->look_at_m = Vec<Body>{2000, 0, 0};
  EXPECT_EQ(simulator->simulate(r).status().code(), absl::StatusCode::kInvalidArgument);
}

// From 357 m up the sea ends 0.6 deg below the horizontal, and the middle is 10 deg below it.
TEST(Image, SkyIsAboveTheHorizonAndSeaBelow) {
  Day d = day(10);
  d.request.image = camera(3, 200, 0.01);
  d.request.image->layer = {ImageLayer::kPath, ImageLayer::kBackground, ImageLayer::kAtSensor};
  d.request.image->camera->field_of_view_rad = 2 * std::atan(3 * 0.002);  // pixels of 4 mrad
  const auto simulator = simulator_of(d.scene);
  const ViewResult view = simulated(*simulator, d.request);
  const double down = std::numbers::pi / 18,
               dip = std::acos(6371e3 / (6371e3 + 10 + 2000 * std::sin(down)));
  const double horizon_px = 100 - std::tan(down - dip) / view.pixel_rad;
  ASSERT_GT(horizon_px, 10);
  for (const SignatureResult& row : view.row) {
    const double sky = at(row, ImageLayer::kBackground, 0),
                 sea = at(row, ImageLayer::kBackground, 3 * 199);
    EXPECT_LT(sky, 0.7 * sea);  // 240 and 290 K
    for (std::uint32_t y = 0; y < 200; ++y) {
      const double of_sky = std::clamp(horizon_px - y, 0.0, 1.0);
      const bool near = std::abs(y + 0.5 - horizon_px) < 1.5;
      EXPECT_NEAR(at(row, ImageLayer::kBackground, 3 * y + 1), of_sky * sky + (1 - of_sky) * sea,
                  near ? 0.3 * sea : 1e-6 * sea)
          << y << ", horizon " << horizon_px;
    }
  }
}

TEST(Image, FramesHaveTheirMarginAndConditionsTheirTemperatures) {
  const auto simulator =
      simulator_of(scene_of(generated("box", 12, 0, 0.02, 4, 2), grey(0.9), lwir()));
  ViewRequest r = request(*simulator, 0, 0, 1000, {320});
  r.condition.push_back(r.condition[0]);
  r.condition[1].part_temperature_k = {280};
  r.selected_condition = {0, 1};
  for (const double margin : {0.0, 0.5, 2.0}) {
    r.image = framed(100, 100, margin);
    const ViewResult view = simulated(*simulator, r);
    double pixels = 0;
    for (const TracedPictures::Met& met : view.seen) {
      pixels += static_cast<double>(met.samples) / view.pixel_samples;
      EXPECT_NEAR(at(view.row[0], ImageLayer::kTemperature, met.pixel), 320, 1e-3);
      EXPECT_NEAR(at(view.row[1], ImageLayer::kTemperature, met.pixel), 280, 1e-3);
    }
    const double wide_px = 100 / (1 + 2 * margin);
    EXPECT_NEAR(pixels, 0.5 * wide_px * wide_px, 0.02 * wide_px * wide_px) << margin;
  }
}

// A pixel is the mean radiance in its own solid angle, also far from the axis.
TEST(Image, RadianceIsTheSameAllOverAWideField) {
  const auto simulator =
      simulator_of(scene_of(generated("box", 12, 0, 0.02, 100, 100), grey(1), lwir()));
  ViewRequest r = request(*simulator, 0, 0, 60, {300});
  r.image = camera(40, 40, 1.2);  // 34 deg at the sides
  const ViewResult view = simulated(*simulator, r);
  ASSERT_EQ(view.seen.size(), 1600u);
  const SignatureResult& row = view.row[0];
  const auto middle = static_cast<double>(row.image_w_m2_sr[20 * 40 + 20]);
  for (const float pixel : row.image_w_m2_sr)
    EXPECT_NEAR(static_cast<double>(pixel), middle, 5e-3 * middle);
}

TEST(Image, ErrorsAreAsSmallAsAskedForAndTrue) {
  Day d = day();
  d.request.image = framed(64, 40);
  d.request.image->layer = {ImageLayer::kAtSensor};
  const auto simulator = simulator_of(d.scene);
  d.request.image->samples = 4096;
  const ViewResult reference = simulated(*simulator, d.request);
  d.request.image->samples = 8;
  d.request.seed = 2;
  const ViewResult rough = simulated(*simulator, d.request);
  d.request.image->relative_error = 0.004;
  const ViewResult fine = simulated(*simulator, d.request);
  d.request.image->relative_error = 0;
  d.request.image->error_k = 0.3;
  const ViewResult fine_k = simulated(*simulator, d.request);
  d.request.image->error_k = 1e-4;
  d.request.image->most_samples = 64;
  EXPECT_EQ(simulated(*simulator, d.request).pixel_samples, 64u) << "the limit";
  EXPECT_GT(std::max(rough.row[0].image_error_relative, rough.row[1].image_error_relative), 0.008);
  EXPECT_GT(fine.pixel_samples, rough.pixel_samples);
  EXPECT_GT(fine.rays, rough.rays);
  EXPECT_GT(fine_k.pixel_samples, rough.pixel_samples);
  std::vector<std::uint32_t> met(reference.row[0].image_w_m2_sr.size(), 0);
  for (const TracedPictures::Met& m : reference.seen) met[m.pixel] += m.samples;
  for (std::size_t b = 0; b < 2; ++b) {
    EXPECT_LE(fine.row[b].image_error_relative, 0.004);
    const LayerImage &seen = fine.row[b].layer[0], &truth = reference.row[b].layer[0];
    double relative = 0, z = 0, inside = 0;
    for (std::size_t i = 0; i < met.size(); ++i) {
      if (met[i] < reference.pixel_samples) continue;
      ++inside;
      const auto pixel = static_cast<double>(reference.row[b].image_w_m2_sr[i]);
      relative += std::pow(static_cast<double>(fine.row[b].image_w_m2_sr[i]) / pixel - 1, 2);
      z += std::pow(static_cast<double>(seen.value[i] - truth.value[i]) /
                        std::hypot(seen.stderr_[i], truth.stderr_[i]),
                    2);
    }
    EXPECT_LE(std::sqrt(relative / inside), 1.3 * 0.004) << b;
    EXPECT_GT(std::sqrt(z / inside), 0.7) << b;
    EXPECT_LT(std::sqrt(z / inside), 1.2) << b;
  }
}

// The errors of each cause's light, by the scatter of seeds around a long run.
TEST(Image, LayersOfLightHaveErrorsThatAreTrue) {
  Day d = day();
  d.request.image = framed(64, 40);
  const auto simulator = simulator_of(d.scene);
  d.request.image->samples = 4096;
  const ViewResult reference = simulated(*simulator, d.request);
  d.request.image->samples = 64;
  std::vector<std::uint32_t> met(reference.row[0].image_w_m2_sr.size(), 0);
  for (const TracedPictures::Met& m : reference.seen) met[m.pixel] += m.samples;
  for (const SignatureResult& row : reference.row)
    for (const LayerImage& image : row.layer)
      EXPECT_EQ(image.stderr_.size(), has_standard_error(image.layer) ? met.size() : 0)
          << name_of(image.layer);
  struct Sum {
    double z = 0, within = 0, pixels = 0;
  };
  std::map<ImageLayer, Sum> of;
  for (std::uint64_t seed = 2; seed < 6; ++seed) {
    d.request.seed = seed;
    const ViewResult rough = simulated(*simulator, d.request);
    for (std::size_t b = 0; b < rough.row.size(); ++b)
      for (std::size_t k = 0; k < rough.row[b].layer.size(); ++k) {
        const LayerImage &seen = rough.row[b].layer[k], &truth = reference.row[b].layer[k];
        if (!has_standard_error(seen.layer)) continue;
        for (std::size_t i = 0; i < met.size(); ++i) {
          const double error = std::hypot(seen.stderr_[i], truth.stderr_[i]);
          if (met[i] < reference.pixel_samples || !(error > 0)) continue;
          const double z = static_cast<double>(seen.value[i] - truth.value[i]) / error;
          Sum& sum = of[seen.layer];
          sum.z += z * z;
          sum.within += std::abs(z) < 1.96 ? 1 : 0;
          ++sum.pixels;
        }
      }
  }
  for (const ImageLayer layer : {ImageLayer::kEmitted, ImageLayer::kSun, ImageLayer::kSky,
                                 ImageLayer::kSurface, ImageLayer::kParts, ImageLayer::kAtSensor}) {
    const Sum& sum = of[layer];
    EXPECT_GT(sum.pixels, 500) << name_of(layer);
    EXPECT_GT(std::sqrt(sum.z / sum.pixels), 0.6) << name_of(layer);
    EXPECT_LT(std::sqrt(sum.z / sum.pixels), 1.3) << name_of(layer);
    EXPECT_GT(sum.within / sum.pixels, 0.9) << name_of(layer);
  }
}

// Sum of a mean over the target, weighted with the fraction that the target fills. [m2]
double area_m2(const ViewResult& view, const SignatureResult& row, ImageLayer layer,
               double range_m) {
  double sum = 0;
  for (const TracedPictures::Met& met : view.seen)
    sum += static_cast<double>(met.samples) / view.pixel_samples * at(row, layer, met.pixel);
  return sum * std::pow(view.pixel_rad * range_m, 2);
}

// A cube shows three faces, each as large as the cosine of its angle makes it.
TEST(Image, NormalsAreThoseOfTheFacesInTheBodyFrame) {
  constexpr double kRange = 1e5, kSide = 2;
  const auto cube =
      simulator_of(scene_of(generated("box", 12, 0, kSide, kSide, kSide), grey(0.9), lwir()));
  for (const double azimuth_deg : {30.0, 200.0}) {
    ViewRequest r = request(*cube, azimuth_deg, 20, kRange, {300});
    r.image = framed(128, 128);
    r.image->layer = {ImageLayer::kNormalX, ImageLayer::kNormalY, ImageLayer::kNormalZ};
    const ViewResult view = simulated(*cube, r);
    const double a = azimuth_deg * std::numbers::pi / 180, e = 20 * std::numbers::pi / 180;
    const Vec<Body> towards{std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), -std::sin(e)};
    const auto sum = [&](ImageLayer layer) { return area_m2(view, view.row[0], layer, kRange); };
    EXPECT_NEAR(sum(ImageLayer::kNormalX), kSide * kSide * towards.x, 0.01);
    EXPECT_NEAR(sum(ImageLayer::kNormalY), kSide * kSide * towards.y, 0.01);
    EXPECT_NEAR(sum(ImageLayer::kNormalZ), kSide * kSide * towards.z, 0.01);
    std::size_t of_one_face = 0;
    for (const TracedPictures::Met& met : view.seen) {
      const Vec<Body> n{at(view.row[0], ImageLayer::kNormalX, met.pixel),
                        at(view.row[0], ImageLayer::kNormalY, met.pixel),
                        at(view.row[0], ImageLayer::kNormalZ, met.pixel)};
      EXPECT_LE(length(n), 1 + 1e-6);
      EXPECT_GT(dot(n, towards), 0);
      of_one_face += length(n) > 1 - 1e-6;
    }
    EXPECT_GT(of_one_face, view.seen.size() * 9 / 10);
  }
  // A sheet with two sides, facing ahead: the side that is seen.
  SceneSpec sheet = scene_of(generated("disk", 64, 1), grey(0.9), lwir());
  sheet.part[0].two_sided = true;
  const auto simulator = simulator_of(sheet);
  for (const double azimuth_deg : {30.0, 150.0}) {
    ViewRequest r = request(*simulator, azimuth_deg, 0, kRange, {300});
    r.image = framed(32, 32);
    r.image->layer = {ImageLayer::kNormalX};
    const ViewResult view = simulated(*simulator, r);
    ASSERT_FALSE(view.seen.empty());
    for (const TracedPictures::Met& met : view.seen)
      EXPECT_NEAR(at(view.row[0], ImageLayer::kNormalX, met.pixel), azimuth_deg < 90 ? 1 : -1,
                  1e-6);
  }
}

// The sun stands behind a wall, 45 deg up, and its shadow covers half of a square; straight above
// there is no shadow; at night there is no sun. Which lights paths follow is another question.
TEST(Image, SunlitIsWhatNoShadowCovers) {
  constexpr double kRange = 1e5, kThick = 0.01;
  Mesh yard = moved(generated("box", 12, 0, 10, 10, kThick), {0, 0, 0.5 * kThick});
  yard = joined(yard, moved(generated("box", 12, 0, kThick, 10, 5), {-5, 0, -2.5}), "wall_");
  const auto simulator = simulator_of(scene_of(yard, grey(0.9), lwir()));
  ViewRequest r = request(*simulator, 0, 60, kRange, {300});
  const auto add_sun = [&](Vec<Body> direction) {
    ConditionSpec c = r.condition[0];
    make_day(c);
    c.surroundings = r.condition[0].surroundings;
    c.sun_direction = normalized(direction);
    c.sun_cos_zenith = -c.sun_direction.z;
    r.condition.push_back(c);
  };
  add_sun({-1, 0, -1});
  add_sun({0, 0, -1});
  add_sun({-1, 0, 0.1});  // set
  r.selected_condition = {0, 1, 2, 3};
  r.image = framed(200, 200);
  r.image->layer = {ImageLayer::kSunlit};
  const double up = std::sin(std::numbers::pi / 3);
  // The wall's upper edge is lit, too.
  const double lit_m2[] = {0, 50 * up, 100 * up, 0};
  for (const std::uint32_t reflections : {0u, 3u}) {
    r.max_reflections = reflections;
    const ViewResult view = simulated(*simulator, r);
    ASSERT_EQ(view.row.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(area_m2(view, view.row[k], ImageLayer::kSunlit, kRange), lit_m2[k],
                  lit_m2[k] > 0 ? 0.25 : 0)
          << k;
      std::size_t whole = 0;
      for (const float value : values(view.row[k], ImageLayer::kSunlit)) {
        ASSERT_TRUE(value >= 0 && value <= 1);
        whole += value == 1;
      }
      EXPECT_EQ(whole > 1000, lit_m2[k] > 0);
    }
  }
  // A selection of few rows has equal bits, and layers of first hits do not change the image.
  const ViewResult all = simulated(*simulator, r);
  r.selected_condition = {1};
  r.image->layer = {};
  const ViewResult bare = simulated(*simulator, r);
  EXPECT_EQ(bare.row[0].image_w_m2_sr, all.row[1].image_w_m2_sr);
  EXPECT_LT(bare.rays, all.rays);
  r.image->layer = {ImageLayer::kSunlit};
  EXPECT_EQ(values(simulated(*simulator, r).row[0], ImageLayer::kSunlit),
            values(all.row[1], ImageLayer::kSunlit));
}

// [m2] What rays cover that meet exactly these parts: in the frame, and beside it.
struct Cover {
  double inside_m2 = 0, outside_m2 = 0;
};
Cover covered(const ViewResult& view, const std::vector<std::uint32_t>& parts, double range_m) {
  const double pixel_m2 = std::pow(view.pixel_rad * range_m, 2);
  for (const ViewResult::PartSet& set : view.part_set) {
    if (set.part != parts) continue;
    double rays = 0;
    for (const TracedPictures::Met& met : set.pixel) rays += met.samples;
    return {pixel_m2 * rays / view.pixel_samples, pixel_m2 * set.outside_px};
  }
  return {};
}

// A block of 4 x 2 m before a wall of 10 x 10 m: 0.08 of the wall is hidden.
TEST(Image, WholePartsShowTheWallBehindABlock) {
  constexpr double kRange = 1e5;
  Mesh mesh = generated("box", 12, 0, 1, 4, 2);
  mesh = joined(mesh, moved(generated("box", 12, 0, 1, 10, 10), {-20, 0, 0}), "wall_");
  SceneSpec scene = scene_of(mesh, grey(0.9), lwir());
  scene.part = {{"wall", {"wall_*"}, 0, false, false}, {"block", {}, 0, false, false, true}};
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 0, 0, kRange, {300, 310});
  r.image = framed(200, 200);
  r.image->layer.clear();
  const ViewResult bare = simulated(*simulator, r);
  EXPECT_TRUE(bare.part_set.empty());
  r.image->whole_parts = true;
  const ViewResult view = simulated(*simulator, r);
  EXPECT_NEAR(covered(view, {0}, kRange).inside_m2, 92, 0.1);
  EXPECT_NEAR(covered(view, {0, 1}, kRange).inside_m2, 8, 0.05);
  EXPECT_EQ(covered(view, {1}, kRange).inside_m2, 0);
  double wall = 0;
  for (const TracedPictures::Met& met : view.seen) wall += met.part == 0 ? met.samples : 0;
  wall *= std::pow(view.pixel_rad * kRange, 2) / view.pixel_samples;
  EXPECT_NEAR(
      1 - wall / (covered(view, {0}, kRange).inside_m2 + covered(view, {0, 1}, kRange).inside_m2),
      0.08, 5e-4);
  for (const ViewResult::PartSet& set : view.part_set) EXPECT_EQ(set.outside_px, 0);
  EXPECT_EQ(view.row[0].image_w_m2_sr, bare.row[0].image_w_m2_sr);
  EXPECT_EQ(view.row[0].image_stderr_w_m2_sr, bare.row[0].image_stderr_w_m2_sr);
  // Rays through the wall have met its front and its back when nothing is behind it.
  EXPECT_GT(view.rays, bare.rays);
  EXPECT_LT(view.rays, 5 * bare.rays);
  // From behind, the wall hides all of the block; a target far below a pixel has its parts, too.
  for (const double margin : {0.1, 50.0}) {
    r.viewpoint = {180, 0, kRange};
    r.image->margin = margin;
    const ViewResult behind = simulated(*simulator, r);
    EXPECT_NEAR(covered(behind, {0, 1}, kRange).inside_m2, 8, 0.4) << margin;
    EXPECT_NEAR(covered(behind, {0}, kRange).inside_m2, 92, 0.5) << margin;
  }
  // With one part nothing stands behind.
  scene.part = {{"all", {"*"}, 0, false, false}};
  const auto one = simulator_of(scene);
  r = request(*one, 0, 0, kRange, {300});
  r.image = framed(200, 200);
  const std::uint64_t rays = simulated(*one, r).rays;
  r.image->whole_parts = true;
  EXPECT_EQ(simulated(*one, r).rays, rays);
}

// Half of a plate, a quarter, and all of it lie outside the frame of a camera.
TEST(Image, WholePartsAreMeasuredBesideTheFrame) {
  constexpr double kRange = 1000;
  const auto simulator =
      simulator_of(scene_of(generated("box", 12, 0, 0.02, 4, 2), grey(0.9), lwir()));
  ViewRequest r = request(*simulator, 0, 0, kRange, {300});
  r.image = camera(100, 100, 2 * std::atan(2 / kRange));  // 4 m wide
  r.image->layer.clear();
  r.image->whole_parts = true;
  struct Case {
    Vec<Body> look_at;
    double outside_m2;
  };
  for (const Case& c : {Case{{0, 0, 0}, 0}, Case{{0, 2, 0}, 4}, Case{{0, -1, 0}, 2},
                        Case{{0, 0, 2}, 4}, Case{{0, 2, -2}, 6}, Case{{0, 50, 0}, 8}}) {
    r.image->camera->look_at_m = c.look_at;
    const ViewResult view = simulated(*simulator, r);
    const Cover plate = covered(view, {0}, kRange);
    // The plate's face is nearer than the plane of the frame by 1e-5.
    EXPECT_NEAR(plate.outside_m2, c.outside_m2, 0.01 * c.outside_m2 + 1e-3) << c.look_at.y;
    EXPECT_NEAR(plate.inside_m2, 8 - c.outside_m2, 0.02) << c.look_at.y;
  }
}

// Rays that look down at a floating hull go through it into the water, where its keel is.
TEST(Image, WholePartsEndAtTheSea) {
  Mesh mesh = generated("box", 12, 0, 20, 10, 4);
  mesh = joined(mesh, moved(generated("box", 12, 0, 16, 8, 2), {0, 0, 4}), "keel_");
  SceneSpec scene = scene_of(mesh, grey(0.9), lwir());
  scene.part = {{"keel", {"keel_*"}, 0, false, false}, {"hull", {}, 0, false, false, true}};
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 60, 30, 1000, {300, 310});
  r.image = framed(100, 60);
  r.image->layer.clear();
  r.image->whole_parts = true;
  const ViewResult dry = simulated(*simulator, r);
  EXPECT_GT(covered(dry, {0, 1}, 1000).inside_m2, 10);
  EXPECT_GT(covered(dry, {0}, 1000).inside_m2, 10);
  make_day(r.condition[0]);
  const ViewResult floating = simulated(*simulator, r);
  ASSERT_EQ(floating.part_set.size(), 1u);
  EXPECT_EQ(floating.part_set[0].part, std::vector<std::uint32_t>{1});
  std::vector<std::uint32_t> first(6000, 0), any(6000, 0);
  for (const TracedPictures::Met& met : floating.seen) first[met.pixel] += met.samples;
  for (const TracedPictures::Met& met : floating.part_set[0].pixel) any[met.pixel] += met.samples;
  EXPECT_EQ(first, any);
}

// A mirror, one facet of 1e-4 pixel, one pixel for all.
TEST(Image, HardFramesAreShown) {
  Day d = day();
  const auto simulator = simulator_of(d.scene);
  for (const ImageSpec& spec :
       {framed(1, 1), framed(1, 64), camera(3, 2, 1e-4), camera(5, 5, 2.0)}) {
    d.request.image = spec;
    for (const SignatureResult& row : simulated(*simulator, d.request).row)
      for (const LayerImage& image : row.layer)
        for (const float value : image.value)
          ASSERT_TRUE(
              std::isfinite(value) &&
              (image.layer >= ImageLayer::kNormalX ? std::abs(value) < 1.001f : value > -1e-3f))
              << name_of(image.layer);
  }
  Mesh speck = generated("box", 12, 0, 10, 10, 10);
  speck = joined(speck, moved(generated("box", 12, 0, 0.001, 0.001, 0.001), {0, 0, -10}), "speck_");
  SceneSpec scene = scene_of(speck, grey(1e-6), lwir());
  const auto mirrors = simulator_of(scene);
  ViewRequest r = request(*mirrors, 45, 20, 1000, {300});
  r.image = framed(32, 32);
  const ViewResult view = simulated(*mirrors, r);
  const auto& range = values(view.row[0], ImageLayer::kRange);
  for (const float value : range) EXPECT_TRUE(value == 0 || (value > 980 && value < 1020));
}

TEST(MeanBetween, IsThatOfStraightLinesAndJumps) {
  const BackgroundDirections nodes({-0.2f, 0.0f, 0.0f, 0.4f});
  const std::vector<double> value = {2, 4, 10, 6};
  const auto mean = [&](double from, double to) { return mean_between(nodes, value, from, to); };
  EXPECT_NEAR(mean(-0.2, 0), 3, 1e-6);
  EXPECT_NEAR(mean(0, 0.4), 8, 1e-6);
  EXPECT_NEAR(mean(-0.1, 0.1), 0.5 * (3.5 + 9.5), 1e-6);
  EXPECT_NEAR(mean(-0.9, -0.5), 2, 1e-6) << "the first, beyond it";
  EXPECT_NEAR(mean(0.5, 0.9), 6, 1e-6) << "the last";
  EXPECT_NEAR(mean(0.3, 0.3), 7, 1e-6);
  EXPECT_NEAR(mean(-1, 1), (0.8 * 2 + 0.2 * 3 + 0.4 * 8 + 0.6 * 6) / 2, 1e-6);
  EXPECT_NEAR(mean_between(BackgroundDirections({0, 0}), {1, 5}, -0.1, 0.3), 4, 1e-6);
}

}  // namespace
}  // namespace irsig
