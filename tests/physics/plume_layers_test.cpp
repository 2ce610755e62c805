// Rationale: images of sweeps with hot gas have layers of what the gas emits and absorbs. Expected:
// the layers add up to the picture; a pixel inside a slab has the emission of one column and,
// before a disk, takes that column's share of the disk's light; the picture with the target and its
// gas less the one without is the row's contrast; where gas, target and surroundings have one
// temperature nothing is seen; errors are the scatter of other seeds. Source: core/gas for one
// column; geometry; the row.
#include <algorithm>
#include <cmath>

#include "core/spectral/planck.h"
#include "tests/physics/plume_view_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kGasRangeM = 1e5;

const std::vector<ImageLayer> kOfGas = {
    ImageLayer::kEmitted,  ImageLayer::kSun,        ImageLayer::kSky,        ImageLayer::kSurface,
    ImageLayer::kParts,    ImageLayer::kPath,       ImageLayer::kBackground, ImageLayer::kHidden,
    ImageLayer::kAtSensor, ImageLayer::kGasEmitted, ImageLayer::kGasAbsorbed};

const LayerImage& layer_of(const SignatureResult& row, ImageLayer layer) {
  const auto found = std::find_if(row.layer.begin(), row.layer.end(),
                                  [&](const LayerImage& image) { return image.layer == layer; });
  EXPECT_NE(found, row.layer.end()) << name_of(layer);
  return *found;
}
double value_in(const SignatureResult& row, ImageLayer layer, std::size_t pixel) {
  return static_cast<double>(layer_of(row, layer).value[pixel]);
}
double stderr_in(const SignatureResult& row, ImageLayer layer, std::size_t pixel) {
  return static_cast<double>(layer_of(row, layer).stderr_[pixel]);
}

// A slab of gas before a black disk of 1 m, half a metre to its side, above a sea.
ViewRequest before_disk(const Simulator& simulator, double kelvin = 320) {
  ViewRequest r = request(simulator, 0, 3, kGasRangeM, {kelvin});
  ConditionSpec& c = r.condition[0];
  c.gas = slab(10, kGasK, 0.5);
  c.surroundings.kind = SurroundingsKind::kSea;
  c.surroundings.sky_temperature_k = 230;
  c.surroundings.sea_temperature_k = 288;
  c.surroundings.sea_emissivity = 1;
  c.air_temperature_k = 285;
  c.above_surface_m = 20;
  r.air = {AirModel::kHomogeneous, 1e-6, 101325, 287, true};
  r.accuracy.samples_per_replicate = 2048;
  r.image.emplace();
  r.image->width_px = 48;
  r.image->height_px = 40;
  r.image->layer = kOfGas;
  return r;
}

ViewResult pictured_gas(const Simulator& simulator, const ViewRequest& r) {
  auto view = simulator.simulate(r);
  EXPECT_TRUE(view.ok()) << view.status();
  return *std::move(view);
}

double change_by_gas(const SignatureResult& row, std::size_t i) {
  return value_in(row, ImageLayer::kGasEmitted, i) - value_in(row, ImageLayer::kGasAbsorbed, i);
}

TEST(PlumeLayers, AddUpToThePicture) {
  const auto simulator = disk(1);
  ViewRequest r = before_disk(*simulator);
  const std::size_t of_target = static_cast<std::size_t>(ImageLayer::kParts) + 1;
  for (const SignatureResult& row : pictured_gas(*simulator, r).row) {
    const std::vector<float>& seen = layer_of(row, ImageLayer::kAtSensor).value;
    const double brightest = *std::max_element(seen.begin(), seen.end());
    double absorbed_beside = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      double sum = change_by_gas(row, i) + value_in(row, ImageLayer::kPath, i) +
                   value_in(row, ImageLayer::kBackground, i) -
                   value_in(row, ImageLayer::kHidden, i);
      for (std::size_t layer = 0; layer < of_target; ++layer)
        sum += value_in(row, kOfGas[layer], i);
      EXPECT_NEAR(sum, static_cast<double>(seen[i]), 1e-6 * brightest) << i;
      if (value_in(row, ImageLayer::kHidden, i) == 0)
        absorbed_beside += value_in(row, ImageLayer::kGasAbsorbed, i);
    }
    EXPECT_GT(absorbed_beside, 0);  // of the background alone
  }
  // Without the light that a sensor sees, layers are at the target, and of its light alone.
  std::erase_if(r.image->layer,
                [](ImageLayer l) { return l > ImageLayer::kParts && !is_of_gas(l); });
  for (const SignatureResult& row : pictured_gas(*simulator, r).row)
    for (std::size_t i = 0; i < row.image_w_m2_sr.size(); ++i) {
      double sum = change_by_gas(row, i);
      for (std::size_t layer = 0; layer < of_target; ++layer)
        sum += value_in(row, kOfGas[layer], i);
      EXPECT_NEAR(sum, static_cast<double>(row.image_w_m2_sr[i]), 2e-6 * std::abs(sum)) << i;
      if (value_in(row, ImageLayer::kEmitted, i) > 0) continue;
      EXPECT_EQ(value_in(row, ImageLayer::kGasAbsorbed, i), 0) << i;
    }
}

TEST(PlumeLayers, APixelHasOneColumnsLight) {
  const auto simulator = disk(1);
  ViewRequest r = before_disk(*simulator);
  r.air = {};  // vacuum
  r.viewpoint.aspect_elevation_deg = 0;
  const Column column = column_of(*simulator, slab_layer(), nullptr);
  const std::vector<double> um = nodes_of(*simulator);
  std::vector<double> taken;
  for (std::size_t i = 0; i < um.size(); ++i)
    taken.push_back(column.absorbed[i] * planck_radiance_w_m2_sr_um(um[i], 320));
  const ViewResult view = pictured_gas(*simulator, r);
  for (const SignatureResult& row : view.row) {
    const double sent = in_band_of(*simulator, row.band, column.emitted),
                 lost = in_band_of(*simulator, row.band, taken);
    std::size_t filled = 0, before = 0;
    for (std::size_t i = 0; i < row.image_w_m2_sr.size(); ++i) {
      const double emitted = value_in(row, ImageLayer::kGasEmitted, i);
      if (!(emitted > 0.999 * sent)) continue;
      ++filled;
      EXPECT_NEAR(emitted, sent, 2e-3 * sent + 3 * stderr_in(row, ImageLayer::kGasEmitted, i));
      if (!(value_in(row, ImageLayer::kEmitted, i) >
            0.999 * *std::max_element(row.layer[0].value.begin(), row.layer[0].value.end())))
        continue;
      ++before;
      EXPECT_NEAR(value_in(row, ImageLayer::kGasAbsorbed, i), lost,
                  3e-3 * lost + 3 * stderr_in(row, ImageLayer::kGasAbsorbed, i));
    }
    EXPECT_GT(filled, 400);
    EXPECT_GT(before, 50);
  }
}

// Behind real air, too, whose lines are those of the gas.
TEST(PlumeLayers, WithLessWithoutTheTargetIsItsContrast) {
  SceneSpec scene = scene_of(generated("disk", 1000, 1), grey(0.9), Band{"CO2", 4.3, 4.6, 0.1, {}});
  scene.spectral_breaks_um = air_band_edges_um(3, 13);
  scene.band.push_back({"water", 8.6, 9.2, 0.2, {}});
  const auto simulator = simulator_of(scene);
  ViewRequest r = before_disk(*simulator);
  r.viewpoint.range_m = 3000;
  r.viewpoint.aspect_elevation_deg = 6;
  r.air = {};
  r.image->width_px = r.image->height_px = 64;
  r.image->samples = 16;
  const WeatherSpec weather{
      {afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kMaritime, 23000}},
      true,
      {SurfaceBoundary::Kind::kRoughSea, 290, 1, 6},
      nullptr};
  auto environment =
      Environment::make({weather}, {{0, false, {0, 0, -1}, 1}}, 20, nodes_of(*simulator));
  ASSERT_TRUE(environment.ok()) << environment.status();
  r.environment = *std::move(environment);
  r.accuracy.samples_per_replicate = 1U << 13U;
  const ViewResult view = pictured_gas(*simulator, r);
  for (const SignatureResult& row : view.row) {
    double sum = 0, square = 0, emitted = 0, change = 0;
    const LayerImage& seen = layer_of(row, ImageLayer::kAtSensor);
    const double of_pixel = std::pow(view.pixel_rad * r.viewpoint.range_m, 2);
    for (std::size_t i = 0; i < seen.value.size(); ++i) {
      sum += of_pixel * (static_cast<double>(seen.value[i]) - value_in(row, ImageLayer::kPath, i) -
                         value_in(row, ImageLayer::kBackground, i));
      square += std::pow(of_pixel * static_cast<double>(seen.stderr_[i]), 2);
      emitted += of_pixel * value_in(row, ImageLayer::kGasEmitted, i);
      change += of_pixel * change_by_gas(row, i);
    }
    const double reflected = row.apparent_plume_reflected_w_sr.value;
    std::printf(
        "sum %.6g +- %.2g, row %.6g +- %.2g; emitted %.6g, row %.6g; change %.6g, row %.6g\n", sum,
        std::sqrt(square), row.contrast_intensity_w_sr.value, row.contrast_numerical_error_w_sr,
        emitted, row.apparent_plume_emitted_w_sr, change,
        row.contrast_plume_w_sr.value - reflected);
    EXPECT_NEAR(emitted, row.apparent_plume_emitted_w_sr - reflected,
                0.004 * row.apparent_plume_emitted_w_sr);
    EXPECT_NEAR(change, row.contrast_plume_w_sr.value - reflected,
                4 * row.contrast_plume_w_sr.stderr_ + 0.005 * emitted);
    EXPECT_NEAR(sum, row.contrast_intensity_w_sr.value - reflected,
                4 * std::hypot(std::sqrt(square), row.contrast_numerical_error_w_sr));
  }
}

TEST(PlumeLayers, ShowNothingWhereAllHasOneTemperature) {
  const auto simulator = disk(1);
  ViewRequest r = before_disk(*simulator, kGasK);
  ConditionSpec& c = r.condition[0];
  c.surroundings.sky_temperature_k = c.surroundings.sea_temperature_k = kGasK;
  r.air = {};  // vacuum
  for (const SignatureResult& row : pictured_gas(*simulator, r).row) {
    const LayerImage& seen = layer_of(row, ImageLayer::kAtSensor);
    const auto black = static_cast<double>(seen.value.front());
    double most = 0, off = 0;
    for (std::size_t i = 0; i < seen.value.size(); ++i) {
      most = std::max(most, value_in(row, ImageLayer::kGasEmitted, i));
      off = std::max(off, std::abs(static_cast<double>(seen.value[i]) - black) -
                              3 * static_cast<double>(seen.stderr_[i]));
    }
    EXPECT_GT(most, 0.03 * black);
    EXPECT_LT(off, 2e-3 * most);
  }
}

TEST(PlumeLayers, ErrorsAreTheScatterOfOtherSeeds) {
  constexpr int kSeeds = 12;
  const auto simulator = disk(1);
  ViewRequest r = before_disk(*simulator);
  r.accuracy.samples_per_replicate = 256;
  std::vector<ViewResult> view;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    r.seed = static_cast<std::uint64_t>(seed);
    view.push_back(pictured_gas(*simulator, r));
  }
  for (const ImageLayer layer :
       {ImageLayer::kGasEmitted, ImageLayer::kGasAbsorbed, ImageLayer::kAtSensor}) {
    double squares = 0, pixels = 0;
    for (std::size_t i = 0; i < view[0].row[0].image_w_m2_sr.size(); ++i) {
      double mean = 0, scatter = 0, stated = 0;
      for (const ViewResult& v : view) mean += value_in(v.row[0], layer, i) / kSeeds;
      for (const ViewResult& v : view) {
        scatter += std::pow(value_in(v.row[0], layer, i) - mean, 2) / (kSeeds - 1);
        stated += std::pow(stderr_in(v.row[0], layer, i), 2) / kSeeds;
      }
      if (!(scatter > 1e-6 * mean * mean)) continue;  // rounding: not on an edge
      squares += scatter / stated;
      pixels += 1;
    }
    std::printf("%s: %g pixels, rms z %.3f\n", name_of(layer), pixels, std::sqrt(squares / pixels));
    EXPECT_GT(pixels, 50);
    EXPECT_GT(std::sqrt(squares / pixels), 0.4);
    EXPECT_LT(std::sqrt(squares / pixels), 1.1);
  }
}

}  // namespace
}  // namespace irsig
