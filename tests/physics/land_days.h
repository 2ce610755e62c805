#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/geo/frames.h"
#include "core/land/generate_terrain.h"
#include "core/land/land_scene.h"
#include "core/thermal/land/land_heat.h"
#include "heat_days.h"

// Lands and their days for tests of kinds of land and of their temperatures.
namespace irsig {

inline constexpr double kPi = std::numbers::pi, kDeg = kPi / 180;

inline LandScene land_of(const std::function<double(double, double)>& z, double half_m,
                         double spacing_m) {
  HeightGrid grid{-half_m, -half_m, spacing_m, 0, 0, {}};
  grid.columns = grid.rows = static_cast<std::uint32_t>(std::lround(2 * half_m / spacing_m));
  for (std::uint32_t row = 0; row <= grid.rows; ++row)
    for (std::uint32_t column = 0; column <= grid.columns; ++column)
      grid.z_m.push_back(
          static_cast<float>(z(grid.west_m + column * spacing_m, grid.south_m + row * spacing_m)));
  auto field = HeightField::create(std::move(grid));
  EXPECT_TRUE(field.ok()) << field.status();
  LandScene out;
  out.field = std::make_shared<const HeightField>(*std::move(field));
  return out;
}

// Made-up hills of so many metres, as local metres around the target.
inline LandScene hills(double relief_m) {
  const double width_m = 3000, spacing_m = 20;
  const auto raster = generate_terrain({5, width_m, spacing_m, relief_m}, "heights");
  EXPECT_TRUE(raster.ok()) << raster.status();
  const auto columns = raster->columns;
  return land_of(
      [&](double x, double y) {
        const auto at = [&](double along) {
          return static_cast<std::size_t>(
              std::clamp(along / spacing_m + 0.5 * (columns - 1), 0.0, columns - 1.0));
        };
        return static_cast<double>(raster->height_m[(columns - 1 - at(y)) * columns + at(x)]);
      },
      1400, spacing_m);
}

// Level land under a free horizon, of materials whose temperatures are computed or stated.
inline LandKinds level_land(const std::vector<bool>& computed) {
  LandKinds kinds;
  kinds.materials = static_cast<std::uint32_t>(computed.size());
  kinds.computed = computed;
  kinds.on_objects.assign(computed.size(), false);
  kinds.horizon.resize(1);
  kinds.index_kinds();
  return kinds;
}

inline LandHeatRequest land_day(double step_s, double turned_deg = 0) {
  const SceneHeatRequest day = clear_day(step_s, turned_deg);
  LandHeatRequest out;
  out.knot_s = day.knot_s;
  out.weather = day.weather;
  out.day_knots = day.day_knots;
  out.output_knot = day.output_knot;
  out.heading_deg = turned_deg;
  out.material = {LandHeatMaterial{day.build_up[0], 0.75, 0.94}};
  out.stated_k = {0};
  return out;
}

inline LandHeatResult solved(const LandKinds& kinds, const LandHeatRequest& request) {
  auto out = solve_land_heat(kinds, request);
  EXPECT_TRUE(out.ok()) << out.status();
  return *std::move(out);
}

inline Vec<Enu> tilted(double tilt, double azimuth) {
  return {std::sin(tilt) * std::sin(azimuth), std::sin(tilt) * std::cos(azimuth), std::cos(tilt)};
}

}  // namespace irsig
