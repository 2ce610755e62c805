#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/land/generate_terrain.h"
#include "core/land/place_heights.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

HeightRaster layer_of(const Terrain& terrain, std::string_view layer) {
  auto raster = generate_terrain(terrain, layer);
  EXPECT_TRUE(raster.ok()) << raster.status();
  return *std::move(raster);
}

TEST(Terrain, FractionsAddUpToOne) {
  const Terrain terrain{.seed = 4, .width_m = 6000, .spacing_m = 25};
  std::vector<double> sum(std::size_t{241} * 241, 0.0);
  for (const std::string_view layer : terrain_layers()) {
    if (layer == "heights") continue;
    const HeightRaster raster = layer_of(terrain, layer);
    double covered = 0;
    ASSERT_EQ(raster.height_m.size(), sum.size());
    for (std::size_t i = 0; i < sum.size(); ++i) {
      EXPECT_GE(raster.height_m[i], 0);
      sum[i] += raster.height_m[i];
      covered += raster.height_m[i] / double(sum.size());
    }
    EXPECT_GT(covered, 0.0005) << layer;  // the road: 7 m of 6 km are 0.0012
  }
  for (const double of : sum) EXPECT_EQ(of, 1);
}

// Expected: the river is level across and falls to the east; no land lies below it.
TEST(Terrain, TheRiverIsTheLowestLine) {
  const Terrain terrain{.seed = 9, .width_m = 5000, .spacing_m = 10, .relief_m = 300};
  const HeightRaster heights = layer_of(terrain, "heights"), water = layer_of(terrain, "water");
  double highest = 0;
  int wet = 0;
  for (std::size_t i = 0; i < heights.height_m.size(); ++i) {
    const double x = heights.x0 + double(i % heights.columns) * heights.x_step;
    const double above = heights.height_m[i] + 0.0005 * x;
    EXPECT_GE(above, -1e-4);
    highest = std::max(highest, above);
    if (water.height_m[i] < 1) continue;
    ++wet;
    EXPECT_NEAR(above, 0, 1e-4);
  }
  EXPECT_GT(wet, 500);
  EXPECT_GT(highest, 120);
  EXPECT_LE(highest, 300);
}

TEST(Terrain, SeedAndReliefAloneMakeTheLand) {
  const HeightRaster coarse = layer_of({.seed = 2, .width_m = 2000, .spacing_m = 50}, "heights");
  const HeightRaster fine = layer_of({.seed = 2, .width_m = 1000, .spacing_m = 25}, "heights");
  const HeightRaster other = layer_of({.seed = 3, .width_m = 2000, .spacing_m = 50}, "heights");
  EXPECT_EQ(coarse.height_m,
            layer_of({.seed = 2, .width_m = 2000, .spacing_m = 50}, "heights").height_m);
  EXPECT_NE(coarse.height_m, other.height_m);
  ASSERT_EQ(coarse.columns, 41U);
  ASSERT_EQ(fine.columns, 41U);
  for (std::uint32_t row = 0; row <= 20; ++row)
    for (std::uint32_t column = 0; column <= 20; ++column)
      EXPECT_EQ(coarse.height_m[(10 + row) * 41 + 10 + column],
                fine.height_m[2 * row * 41 + 2 * column]);
}

// Expected: what the command writes is land with the heights that it had.
TEST(Terrain, IsReadAgainAndPlaced) {
  const HeightRaster raster = layer_of({.seed = 5, .width_m = 3000, .spacing_m = 30}, "heights");
  const auto again = read_asc(write_asc(raster), "terrain.asc", LocalMetres{});
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->height_m, raster.height_m);
  EXPECT_EQ(again->x0, raster.x0);
  EXPECT_EQ(again->y0, raster.y0);
  const auto grid =
      place_heights(*again, {{48, 11, 0}, -1500, -1500, 30, 100, 100, 0, std::nullopt});
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_NEAR(grid->z_m[50 * 101 + 50], raster.height_m[50 * 101 + 50], 3e-3);
  EXPECT_TRUE(HeightField::create(*grid).ok());
}

TEST(Terrain, RefusesValuesBeyondTheirRanges) {
  const auto refused = [](const Terrain& terrain, std::string_view layer = "heights") {
    return std::string(generate_terrain(terrain, layer).status().message());
  };
  EXPECT_THAT(refused({.width_m = 50}), HasSubstr("width_m is 50; expected 100 to 400000"));
  EXPECT_THAT(refused({.spacing_m = 0}), HasSubstr("spacing_m is 0"));
  EXPECT_THAT(refused({.spacing_m = std::nan("")}), HasSubstr("spacing_m is nan"));
  EXPECT_THAT(refused({.relief_m = -1}), HasSubstr("relief_m is -1"));
  EXPECT_THAT(refused({.width_m = 4e5, .spacing_m = 1}), HasSubstr("samples is above the limit"));
  EXPECT_THAT(refused({}, "lava"), HasSubstr("layer \"lava\", expected one of heights, asphalt"));
}

}  // namespace
}  // namespace irsig
