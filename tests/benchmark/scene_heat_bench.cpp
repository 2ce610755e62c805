// CPU time of the temperatures of a frigate on a clear summer day, on one core.
//   scene_heat_bench [facets, 20000] [rays of each face, 256]
// Prints CSV: facets, CPU time in s of the sun's shadows (every 10 minutes of two days), of
// exchange factors, of everything (both computations), rounds of exchange, median and 95 % of
// stated errors and largest temperature in K.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "core/scene/generate/generate_mesh.h"
#include "core/thermal/scene/exchange_factors.h"
#include "core/thermal/scene/scene_heat.h"
#include "core/thermal/scene/sun_visibility.h"
#include "core/thermal/weather_course.h"

namespace irsig {
namespace {

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

PartSpec all_parts() {
  PartSpec part;
  part.name = "ship";
  part.rest = true;
  return part;
}

int run(std::uint64_t facets, std::uint32_t rays) {
  const auto mesh = generate_mesh({"frigate", facets, 0, 0, 0, 0});
  if (!mesh.ok()) return 1;
  const auto target = make_target(*mesh, {all_parts()}, widest_isa());
  if (!target.ok()) return 1;
  const double midnight_s = solar_midnight_unix_s(2025, 6, 21, 0);
  const auto course = day_course({288, 298, 15, 283, 101300, 4, 220, 0}, midnight_s);
  if (!course.ok()) return 1;
  const auto radiation = CourseRadiation::make(*course, {45, 0, 0}, {0.2, 0.15, 0.33, 0.06});
  if (!radiation.ok()) return 1;

  SceneHeatRequest request;
  request.part = {{0.7, 0.9, 0u, 0}};
  WallBuildUp wall;
  wall.name = "plate";
  wall.layers = {{2e-4, 0.2, 1200, 1400},
                 {0.008, 50, 7800, 450},
                 {0.05, 0.04, 50, 1030},
                 {0.002, 50, 7800, 450},
                 {2e-4, 0.2, 1200, 1400}};
  wall.inner_side = InnerSide::kAir;
  wall.inner_k = 295;
  wall.inner_h_w_m2_k = 8;
  request.build_up = {wall};
  request.beneath = {true, 0, 290, 0.93, 0.06, 0};
  request.rays = rays;
  for (int k = 0; k <= 144; ++k) {
    const double t = midnight_s + 600.0 * k;
    const WeatherRecord w = weather_at(*course, t);
    const SunPosition sun = radiation->sun_at(t);
    const auto side = [&](CourseRadiation::Side which) {
      const Radiation r = radiation->at(t, which);
      return HeatRadiation{r.direct_normal_w_m2, r.diffuse_horizontal_w_m2, r.sky_w_m2};
    };
    request.knot_s.push_back(t);
    request.weather.push_back({w.air_k,
                               w.wind_m_s,
                               {1, 0, 0},
                               body_from_enu(sun.direction, 30),
                               0.0047,
                               side(CourseRadiation::Side::kBefore),
                               side(CourseRadiation::Side::kAfter)});
    if (k % 6 == 0) request.output_knot.push_back(static_cast<std::size_t>(k));
  }
  request.day_knots = 144;

  const ThermalFaces faces = make_thermal_faces(*target);
  double begin = cpu_s();
  std::vector<float> lit(faces.size());
  for (int day = 0; day < 2; ++day)
    for (const HeatWeather& w : request.weather)
      sun_visibility(*target, faces, {w.sun, 0.0047}, {}, lit);
  const double shadows_s = cpu_s() - begin;
  begin = cpu_s();
  const ExchangeFactors factors = exchange_factors(*target, faces, {.rays = rays});
  const double factors_s = cpu_s() - begin;
  begin = cpu_s();
  const auto result = solve_scene_heat(*target, request);
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.status().ToString().c_str());
    return 1;
  }
  const double all_s = cpu_s() - begin;
  std::vector<float> error;
  float hottest = 0;
  for (std::size_t t = 0; t < result->kelvin.size(); ++t)
    for (std::size_t f = 0; f < result->kelvin[t].size(); ++f) {
      if (std::isnan(result->kelvin[t][f])) continue;
      error.push_back(result->error_k[t][f]);
      hottest = std::max(hottest, result->kelvin[t][f]);
    }
  std::sort(error.begin(), error.end());
  std::printf("%zu,%.2f,%.2f,%.1f,%d,%.4f,%.4f,%.2f\n", target->facet.size(), shadows_s, factors_s,
              all_s, result->exchange_rounds, static_cast<double>(error[error.size() / 2]),
              static_cast<double>(error[error.size() * 95 / 100]), static_cast<double>(hottest));
  std::printf("# %zu pairs exchange; %.4f K left\n", factors.to.size(), result->exchange_left_k);
  return 0;
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  std::printf("facets,shadows_s,factors_s,all_s,rounds,error_median_k,error_95_k,hottest_k\n");
  return irsig::run(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 20000,
                    argc > 2 ? static_cast<std::uint32_t>(std::atoi(argv[2])) : 256);
}
