// Rationale: a map ends somewhere, and the ground that goes on beyond it is level, at the height of
// the land below the target. Expected: steps are found where both differ, and a fade leaves none.
// Source: a plateau around a plain, whose fade is a cubic of the distance from the edge;
// height_m().
#include "core/land/map_edge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace irsig {
namespace {

using ::testing::HasSubstr;

constexpr GeodeticPosition kMiddle{48, 11, 520};
constexpr double kPlainM = 30;  // z of the land at the origin

// Heights above the level ground by a function of x and y.
HeightGrid grid_above(const GeodeticPosition& origin, double west_m, double south_m,
                      double spacing_m, std::uint32_t cells,
                      const std::function<double(double, double)>& above_m) {
  HeightGrid out{west_m, south_m, spacing_m, cells, cells, {}};
  for (std::uint32_t row = 0; row <= cells; ++row)
    for (std::uint32_t column = 0; column <= cells; ++column) {
      const double x = west_m + column * spacing_m, y = south_m + row * spacing_m;
      out.z_m.push_back(static_cast<float>(level_z_m(origin, kPlainM, x, y) + above_m(x, y)));
    }
  return out;
}

// A plain of 2 km around the origin within a plateau of 80 m.
double plateau_m(double x, double y) { return std::max(std::abs(x), std::abs(y)) > 2000 ? 80 : 0; }

HeightField edged_field(HeightGrid outer, std::optional<HeightGrid> inset = std::nullopt) {
  auto field = HeightField::create(std::move(outer), std::move(inset));
  EXPECT_TRUE(field.ok()) << field.status();
  return *std::move(field);
}

TEST(LandEdge, LevelGroundHasOneHeightWhereverItIs) {
  for (const GeodeticPosition origin :
       {kMiddle, GeodeticPosition{0, 179.999, -20}, GeodeticPosition{-16, -180, 3},
        GeodeticPosition{88.9, 12, 2800}, GeodeticPosition{-88.9, -179.5, 4000}})
    for (const double x : {-400e3, -2e3, 0.0, 31e3})
      for (const double y : {-70e3, 0.0, 400e3})
        EXPECT_NEAR(height_m(origin, {x, y, level_z_m(origin, 55, x, y)}), origin.height_m + 55,
                    1e-5)
            << origin.latitude_deg << " " << origin.longitude_deg << " " << x << " " << y;
  EXPECT_NEAR(level_z_m(kMiddle, kPlainM, 0, 0), kPlainM, 1e-8);
}

TEST(LandEdge, APlateauFadesToTheGroundBeyond) {
  for (const GeodeticPosition origin :
       {kMiddle, GeodeticPosition{10, 180, 520}, GeodeticPosition{88.5, 0, 520}}) {
    const HeightField land = edged_field(grid_above(origin, -5000, -5000, 50, 200, plateau_m));
    const auto faded = fade_edge(edged_field(HeightGrid(land.outer())), origin, 1500);
    ASSERT_TRUE(faded.ok()) << faded.status();
    for (std::size_t i = 0; i < land.outer().z_m.size(); ++i) {
      const double x = -5000 + 50.0 * double(i % 201), y = -5000 + 50.0 * double(i / 201);
      const double inside_m = 5000 - std::max(std::abs(x), std::abs(y));
      const float found_m = faded->outer().z_m[i];
      if (inside_m >= 1500) {
        ASSERT_EQ(found_m, land.outer().z_m[i]) << x << " " << y;
        continue;
      }
      const double u = inside_m / 1500;
      ASSERT_NEAR(found_m, level_z_m(origin, kPlainM, x, y) + 80 * u * u * (3 - 2 * u), 1e-4)
          << x << " " << y;
    }
    EXPECT_EQ(faded->z_m(0, 0), land.z_m(0, 0));
    EXPECT_EQ(faded->z_m(1790, 40), land.z_m(1790, 40));
    const auto steps = edge_steps(*faded, origin);
    ASSERT_TRUE(steps.ok()) << steps.status();
    EXPECT_EQ(steps->size(), 0U);
  }
}

TEST(LandEdge, AnInsetNearTheEdgeFadesWithItsMap) {
  const auto hills_m = [](double x, double y) { return 20 * std::sin(x / 170) * std::cos(y / 90); };
  const HeightField land = edged_field(grid_above(kMiddle, -3000, -3000, 50, 120, hills_m),
                                       grid_above(kMiddle, 2000, -500, 10, 100, hills_m));
  const auto faded =
      fade_edge(edged_field(HeightGrid(land.outer()), HeightGrid(*land.inset())), kMiddle, 600);
  ASSERT_TRUE(faded.ok()) << faded.status();
  ASSERT_NE(faded->inset(), nullptr);
  int checked = 0;
  for (std::uint32_t row = 1; row < 100; ++row)
    for (std::uint32_t column = 1; column < 100; ++column, ++checked) {
      const double x = 2000 + 10.0 * column, y = -500 + 10.0 * row;
      const double u = std::min(1.0, (3000 - x) / 600);
      ASSERT_NEAR(faded->inset()->z_m[row * 101 + column],
                  level_z_m(kMiddle, kPlainM, x, y) + u * u * (3 - 2 * u) * hills_m(x, y), 1e-4);
    }
  EXPECT_EQ(checked, 99 * 99);
  // At the seam both have one height: the inset's outermost vertices lie on the map's edges.
  for (const double y : {-500.0, 500.0})
    for (double x = 2005; x < 3000; x += 10)
      EXPECT_NEAR(*faded->z_m(x, y - 1e-7), *faded->z_m(x, y + 1e-7), 1e-4) << x << " " << y;
  EXPECT_EQ(edge_steps(*faded, kMiddle)->size(), 0U);
  EXPECT_GT(edge_steps(land, kMiddle)->size(), 400U);
}

TEST(LandEdge, AFadeOfNoWidthChangesNothingAndOneToTheTargetIsRefused) {
  const HeightField land = edged_field(grid_above(kMiddle, -5000, -4000, 50, 200, plateau_m));
  const auto fade = [&](double width_m) {
    return fade_edge(edged_field(HeightGrid(land.outer())), kMiddle, width_m);
  };
  ASSERT_TRUE(fade(0).ok());
  EXPECT_EQ(fade(0)->outer().z_m, land.outer().z_m);
  // The map's south side is 4000 m from the target, and its cells are 50 m wide.
  ASSERT_TRUE(fade(3950).ok());
  EXPECT_EQ(fade(3950)->z_m(0, 0), land.z_m(0, 0));
  for (const double width_m : {3951.0, 4000.0, 1e5, -1.0, std::nan("")})
    EXPECT_THAT(std::string(fade(width_m).status().message()),
                HasSubstr("reaches the target, whose place lies 4000 m from the edge of the map; "
                          "expected at most 3950 m"))
        << width_m;
  const auto beyond =
      fade_edge(edged_field(grid_above(kMiddle, 100, 100, 50, 20, plateau_m)), kMiddle, 10);
  EXPECT_THAT(std::string(beyond.status().message()), HasSubstr("lies beyond the map"));
}

TEST(LandEdge, StepsAreThoseOfMoreThanAMetre) {
  for (const double above_m : {0.99, -0.99, 1.01, -1.01}) {
    const auto ring_m = [&](double x, double y) { return plateau_m(x, y) * above_m / 80; };
    const auto steps =
        edge_steps(edged_field(grid_above(kMiddle, -5000, -5000, 100, 100, ring_m)), kMiddle);
    ASSERT_TRUE(steps.ok());
    if (std::abs(above_m) < 1) {
      EXPECT_EQ(steps->size(), 0U) << above_m;
      continue;
    }
    ASSERT_EQ(steps->size(), 400U);  // each vertex of the edge once
    for (const EdgeStep& at : *steps) {
      EXPECT_EQ(std::max(std::abs(at.x_m), std::abs(at.y_m)), 5000);
      EXPECT_NEAR(at.land_z_m - at.ground_z_m, above_m, 1e-4);
      EXPECT_EQ(at.ground_z_m, level_z_m(kMiddle, kPlainM, at.x_m, at.y_m));
    }
  }
}

}  // namespace
}  // namespace irsig
