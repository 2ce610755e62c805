#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/thermal/scene/scene_heat.h"
#include "core/thermal/weather_course.h"

// Weather and walls for tests of the heat balance of scenes.
namespace irsig {

// A day with the same weather throughout.
inline SceneHeatRequest steady(double air_k, double sky_w_m2, std::size_t knots = 49) {
  SceneHeatRequest r;
  for (std::size_t k = 0; k < knots; ++k) {
    r.knot_s.push_back(86400.0 * static_cast<double>(k) / static_cast<double>(knots - 1));
    r.weather.push_back(
        {air_k, 0, {1, 0, 0}, {0, 0, 1}, 0.0047, {0, 0, sky_w_m2}, {0, 0, sky_w_m2}});
  }
  r.day_knots = knots - 1;
  r.output_knot = {0, knots / 4 * 2};
  r.beneath.surface_z_m = INFINITY;
  return r;
}
inline WallBuildUp steel(InnerSide side) {
  WallBuildUp out;
  out.name = "steel";
  out.layers = {{0.005, 45, 7850, 490}};
  out.inner_side = side;
  return out;
}

// A clear summer day at 45 N, every step_s; what stands there is turned by turned_deg.
inline SceneHeatRequest clear_day(double step_s, double turned_deg = 0) {
  SceneHeatRequest r;
  const double midnight_s = solar_midnight_unix_s(2025, 6, 21, 0);
  const auto course = day_course({288, 298, 15, 283, 101300, 3, 220, 0}, midnight_s);
  EXPECT_TRUE(course.ok()) << course.status();
  const auto radiation = CourseRadiation::make(*course, {45, 0, 0}, {0.2, 0.15, 0.33, 0.2});
  EXPECT_TRUE(radiation.ok()) << radiation.status();
  const auto knots = static_cast<std::size_t>(std::lround(86400 / step_s));
  const double from = (220 - turned_deg) * std::numbers::pi / 180;
  for (std::size_t k = 0; k <= knots; ++k) {
    const double t = midnight_s + step_s * static_cast<double>(k);
    const WeatherRecord w = weather_at(*course, t);
    const auto side = [&](CourseRadiation::Side which) {
      const Radiation at = radiation->at(t, which);
      return HeatRadiation{at.direct_normal_w_m2, at.diffuse_horizontal_w_m2, at.sky_w_m2};
    };
    r.knot_s.push_back(t);
    r.weather.push_back({w.air_k,
                         w.wind_m_s,
                         {std::cos(from), std::sin(from), 0},
                         body_from_enu(radiation->sun_at(t).direction, turned_deg),
                         0.0047,
                         side(CourseRadiation::Side::kBefore),
                         side(CourseRadiation::Side::kAfter)});
    if (k % (knots / 24) == 0) r.output_knot.push_back(k);
  }
  r.day_knots = knots;
  r.beneath = {.surface_z_m = 0.5, .temperature_k = 293, .emissivity = 0.95, .solar_albedo = 0.2};
  WallBuildUp soil;
  soil.name = "soil";
  soil.layers = {{0.6, 1.0, 1800, 1000}};
  r.build_up = {soil, steel(InnerSide::kAir)};
  r.build_up[1].inner_k = 294;
  r.build_up[1].inner_h_w_m2_k = 8;
  r.part = {{0.75, 0.94, 0u, 0}, {0.6, 0.9, 1u, 0}};
  return r;
}

}  // namespace irsig
