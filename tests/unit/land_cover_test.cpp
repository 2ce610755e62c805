#include "core/land/land_cover.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/geo/map_coordinates.h"
#include "core/land/choose_map.h"
#include "core/land/generate_terrain.h"
#include "core/land/place_heights.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

constexpr GeodeticPosition kOrigin{48.1, 11.5, 500};

HeightField flat(double width_m, double spacing_m, double west_m, double south_m) {
  HeightGrid grid{west_m, south_m, spacing_m, 0, 0, {}};
  grid.columns = grid.rows = static_cast<std::uint32_t>(std::round(width_m / spacing_m));
  grid.z_m.assign((grid.columns + std::size_t{1}) * (grid.rows + std::size_t{1}), 0.0F);
  auto field = HeightField::create(std::move(grid));
  EXPECT_TRUE(field.ok()) << field.status();
  return *std::move(field);
}

// Samples of local metres, rows from the north.
HeightRaster local(double x0, double y0, double step, std::uint32_t columns,
                   const std::vector<float>& value) {
  return {.system = LocalMetres{},
          .x0 = x0,
          .y0 = y0,
          .x_step = step,
          .y_step = -step,
          .columns = columns,
          .rows = static_cast<std::uint32_t>(value.size() / columns),
          .height_m = value};
}

std::vector<float> at(const LandCover& cover, double x_m, double y_m) {
  std::vector<float> out(cover.materials());
  cover.at(x_m, y_m, out);
  return out;
}

std::string error_of(const std::vector<CoverLayer>& layers, const HeightField& field) {
  const auto cover = LandCover::create(layers, field, kOrigin);
  EXPECT_TRUE(absl::IsInvalidArgument(cover.status())) << cover.status();
  return std::string(cover.status().message());
}

TEST(LandCover, OneMaterialCoversAllWithoutAMap) {
  const auto cover =
      LandCover::create(std::vector<CoverLayer>{{"a"}}, flat(100, 10, -50, -50), kOrigin);
  ASSERT_TRUE(cover.ok()) << cover.status();
  EXPECT_EQ(cover->materials(), 1U);
  EXPECT_EQ(cover->memory_bytes(), 0U);
  EXPECT_EQ(at(*cover, 1e6, -3), std::vector<float>{1});
  EXPECT_EQ(LandCover().materials(), 1U);
}

// Rationale: the cover is that of the nearest sample, and rows of a raster come from the north.
// Expected: at each place within half a step of a sample that sample's fractions, to 1/255; beyond
// the map's edge those of the edge.
TEST(LandCover, HasTheFractionsOfTheNearestSample) {
  const std::vector<float> value = {0, 0.25, 1, 0.5, 0.125, 0.75, 1, 0, 0.0625};
  const auto cover =
      LandCover::create(std::vector<CoverLayer>{{"a", local(-10, 10, 10, 3, value)}, {"b"}},
                        flat(20, 10, -10, -10), kOrigin);
  ASSERT_TRUE(cover.ok()) << cover.status();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      for (const double off_m : {-4.9, 0.0, 4.9}) {
        const auto here = at(*cover, -10 + 10 * column + off_m, 10 - 10 * row - off_m);
        const float expected = value[static_cast<std::size_t>(3 * row + column)];
        EXPECT_NEAR(here[0], expected, 0.5 / 255 + 1e-6) << row << " " << column;
        EXPECT_FLOAT_EQ(here[0] + here[1], 1) << row << " " << column;
      }
  EXPECT_EQ(at(*cover, -1e5, 1e5), at(*cover, -10, 10));
  EXPECT_EQ(at(*cover, 1e5, -1e5), at(*cover, 10, -10));
  EXPECT_EQ(cover->memory_bytes(), 18U);
}

// Rationale: bytes cannot hold thirds, and light must not be lost for it.
// Expected: each fraction within 1/255, and a sum of 1 within rounding.
TEST(LandCover, KeepsTheSumOfFractions) {
  std::vector<CoverLayer> layers;
  for (const char* key : {"a", "b", "c"})
    layers.push_back({key, local(-10, 10, 10, 3, std::vector<float>(9, 1 / 3.0F))});
  const auto cover = LandCover::create(layers, flat(20, 10, -10, -10), kOrigin);
  ASSERT_TRUE(cover.ok()) << cover.status();
  const auto here = at(*cover, 3, 3);
  EXPECT_FLOAT_EQ(here[0] + here[1] + here[2], 1);
  for (const float fraction : here) EXPECT_NEAR(fraction, 1 / 3.0, 1 / 255.0);
}

TEST(LandCover, RefusesMapsThatDoNotFit) {
  const HeightField field = flat(20, 10, -10, -10);
  const auto map = [](std::vector<float> value) { return local(-10, 10, 10, 3, value); };
  std::vector<float> half(9, 0.5F);
  EXPECT_THAT(error_of({{"a", map(half)}}, field),
              HasSubstr("a: the fractions of all materials at row 3, column 1 (x = -10 m, y = -10 "
                        "m from the target) add up to 0.5 = 0.5, expected 1 within 1/64"));
  std::vector<float> wrong = half;
  wrong[5] = 0.52F;
  EXPECT_THAT(error_of({{"a", map(half)}, {"b", map(wrong)}}, field),
              HasSubstr("a: the fractions of all materials at row 2, column 3 (x = 10 m, y = 0 m "
                        "from the target) add up to 0.5 + 0.52 = 1.02"));
  wrong[5] = 0.51F;  // within the rounding of maps in bytes
  EXPECT_TRUE(LandCover::create(std::vector<CoverLayer>{{"a", map(half)}, {"b", map(wrong)}}, field,
                                kOrigin)
                  .ok());
  wrong[5] = 1.5F;
  EXPECT_THAT(error_of({{"a", map(wrong)}, {"b"}}, field),
              HasSubstr("a: the sample in row 2, column 3 is 1.5, expected a fraction from 0 to 1; "
                        "bytes from 0 to 255 are converted by gdal_translate"));
  wrong[5] = NAN;
  EXPECT_THAT(error_of({{"a", map(wrong)}, {"b"}}, field),
              HasSubstr("a: the sample in row 2, column 3 is missing"));
  std::vector<float> most(9, 0.6F);
  EXPECT_THAT(error_of({{"a", map(most)}, {"b", map(most)}, {"c"}}, field),
              HasSubstr("add up to 0.6 + 0.6 = 1.2, expected at most 1 + 1/64"));
  EXPECT_THAT(error_of({{"a"}, {"b"}}, field), HasSubstr("b: two materials have no map"));
  EXPECT_THAT(error_of({{"a", map(half)}, {"b"}}, flat(40, 10, -10, -10)),
              HasSubstr("a: the map of fractions ends before the map of heights"));
}

// Rationale: fractions in UTM must lie under the heights in UTM, whose grid is turned against the
// local frame by the convergence of meridians (1.86 degrees here).
// Expected: along the border of two materials, which follows a northing of the grid, the cover
// changes within half a sample and half a cell of that northing's place.
TEST(LandCover, LiesUnderHeightsOfAMapProjection) {
  constexpr double kStep = 20;
  const UtmZone zone{32, false};
  const UtmPoint middle = utm_point(zone, kOrigin.latitude_deg, kOrigin.longitude_deg);
  HeightRaster heights{.system = zone,
                       .x0 = middle.easting_m - 150 * kStep,
                       .y0 = middle.northing_m + 150 * kStep,
                       .x_step = kStep,
                       .y_step = -kStep,
                       .columns = 301,
                       .rows = 301,
                       .height_m = std::vector<float>(301 * 301, 700.0F)};
  HeightRaster north = heights;
  for (std::size_t i = 0; i < north.height_m.size(); ++i)
    north.height_m[i] = i / 301 <= 150 ? 1.0F : 0.0F;  // as far as the origin's row
  const auto map = choose_map(heights, {.origin = kOrigin});
  ASSERT_TRUE(map.ok()) << map.status();
  auto grid = place_heights(heights, *map);
  ASSERT_TRUE(grid.ok()) << grid.status();
  const auto field = HeightField::create(*std::move(grid));
  ASSERT_TRUE(field.ok()) << field.status();
  const auto cover =
      LandCover::create(std::vector<CoverLayer>{{"north", north}, {"rest"}}, *field, kOrigin);
  ASSERT_TRUE(cover.ok()) << cover.status();
  int changes = 0;
  for (double x_m = -2500; x_m <= 2500; x_m += 100)
    for (double y_m = -400; y_m <= 400; y_m += 1) {
      const double z_m = field->z_m(x_m, y_m).value();
      const GeodeticPosition here = geodetic_position(kOrigin, {x_m, y_m, z_m});
      const double from_border_m =
          utm_point(zone, here.latitude_deg, here.longitude_deg).northing_m -
          (middle.northing_m - kStep / 2);
      if (std::abs(from_border_m) < 0.5 * kStep * std::sqrt(2.0) + 0.1) continue;
      ++changes;
      ASSERT_EQ(at(*cover, x_m, y_m)[0], from_border_m > 0 ? 1.0F : 0.0F) << x_m << " " << y_m;
    }
  EXPECT_GT(changes, 30000);
}

TEST(ChooseMap, VerticesOfLocalMetresAreSamples) {
  const auto raster = generate_terrain({.seed = 1, .width_m = 2000, .spacing_m = 20}, "heights");
  ASSERT_TRUE(raster.ok()) << raster.status();
  const auto map = choose_map(*raster, {.origin = kOrigin, .width_m = 1010});
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_EQ(map->spacing_m, 20);
  EXPECT_EQ(map->west_m, -500);
  EXPECT_EQ(map->columns, 50U);
  const auto whole = choose_map(*raster, {.origin = kOrigin});
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_EQ(whole->west_m, -1000);
  EXPECT_EQ(whole->south_m, -1000);
  EXPECT_EQ(whole->columns, 100U);
}

// Rationale: the outermost vertices must have heights, whatever the system of the raster.
// Expected: place_heights() finds all of them; the map has more than 90 % of the raster's area.
TEST(ChooseMap, AllVerticesHaveHeights) {
  const auto expect_whole = [](HeightRaster raster, const GeodeticPosition& origin,
                               double area_m2) {
    raster.height_m.assign(std::size_t{raster.columns} * raster.rows, 100.0F);
    for (std::size_t i = 0; i < raster.height_m.size(); ++i)
      raster.height_m[i] = float(i * 7919 % 3000);
    const auto map = choose_map(raster, {.origin = origin});
    ASSERT_TRUE(map.ok()) << map.status();
    const auto grid = place_heights(raster, *map);
    EXPECT_TRUE(grid.ok()) << grid.status();
    EXPECT_GT(map->columns * map->spacing_m * map->rows * map->spacing_m, 0.9 * area_m2);
  };
  const double step = 1 / 1200.0;
  expect_whole({.system = GeographicDegrees{},
                .x0 = 11,
                .y0 = 49,
                .x_step = step,
                .y_step = -step,
                .columns = 601,
                .rows = 601,
                .height_m = {}},
               {48.8, 11.1, 300}, 0.5 * 111195 * 0.5 * 111195 * std::cos(0.852));
  const UtmZone zone{32, false};
  const UtmPoint middle = utm_point(zone, 48.1, 11.5);
  expect_whole({.system = zone,
                .x0 = middle.easting_m - 20000,
                .y0 = middle.northing_m + 25000,
                .x_step = 100,
                .y_step = -100,
                .columns = 501,
                .rows = 501,
                .height_m = {}},
               {48.1, 11.5, 500}, 50000.0 * 50000);
}

TEST(ChooseMap, RefusesAMapWithoutTheTarget) {
  const auto raster = generate_terrain({.seed = 1, .width_m = 2000, .spacing_m = 20}, "heights");
  HeightRaster moved = *raster;
  moved.x0 += 5000;
  EXPECT_THAT(std::string(choose_map(moved, {.origin = kOrigin}).status().message()),
              HasSubstr("the map does not contain the target's place (latitude 48.1, longitude "
                        "11.5): column -200, row 50 of 101 x 101 samples"));
  EXPECT_THAT(
      std::string(choose_map(*raster, {.origin = kOrigin, .width_m = 3000}).status().message()),
      HasSubstr("the map does not cover a square of 3000 m around the target; it covers x = -1000 "
                "to 1000 m and y = -1000 to 1000 m from the target"));
  EXPECT_TRUE(choose_map(*raster, {.origin = kOrigin, .fill_m = 0, .width_m = 3000}).ok());
}

// Expected: an inset of 7 m becomes one of 20 / 3 m on whole cells of the map around it, and its
// field is made.
TEST(ChooseInset, CoversWholeCellsOfTheMapAroundIt) {
  const auto raster = generate_terrain({.seed = 1, .width_m = 2000, .spacing_m = 20}, "heights");
  const auto finer = generate_terrain({.seed = 1, .width_m = 700, .spacing_m = 7}, "heights");
  ASSERT_TRUE(raster.ok() && finer.ok());
  const MapChoice choice{.origin = kOrigin};
  const auto map = choose_map(*raster, choice);
  ASSERT_TRUE(map.ok()) << map.status();
  auto outer = place_heights(*raster, *map);
  ASSERT_TRUE(outer.ok()) << outer.status();
  const auto inset_map = choose_inset(*finer, choice, *outer);
  ASSERT_TRUE(inset_map.ok()) << inset_map.status();
  EXPECT_DOUBLE_EQ(inset_map->spacing_m, 20 / 3.0);
  EXPECT_EQ(inset_map->west_m, -340);
  EXPECT_EQ(inset_map->columns, 34U * 3);
  auto inset = place_heights(*finer, *inset_map);
  ASSERT_TRUE(inset.ok()) << inset.status();
  const auto field = HeightField::create(*std::move(outer), *std::move(inset));
  EXPECT_TRUE(field.ok()) << field.status();
  HeightRaster away = *finer;
  away.x0 += 5000;
  EXPECT_THAT(std::string(choose_inset(away, choice, field->outer()).status().message()),
              HasSubstr("covers no cell of the map around it"));
}

}  // namespace
}  // namespace irsig
