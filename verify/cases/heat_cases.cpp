#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/thermal/heat_solver.h"
#include "core/thermal/scene/scene_heat.h"
#include "core/thermal/scene/thermal_faces.h"
#include "core/thermal/weather_course.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"

namespace irsig {
namespace {

double black_w_m2(double t) { return kStefanBoltzmannWM2K4 * t * t * t * t; }

// The constant exposure of a face.
struct Always {
  double absorbed_w_m2 = 0, incoming_w_m2 = 0, fluid_k = 300, forced_h_w_m2_k = 0;
};

std::vector<double> every(double step_s, std::size_t count) {
  std::vector<double> out;
  for (std::size_t i = 0; i <= count; ++i) out.push_back(step_s * static_cast<double>(i));
  return out;
}

// One element of a wall from one temperature on. Out: temperatures of both faces at every knot but
// the first, [knot x 2 + face].
absl::StatusOr<std::vector<double>> walls(std::vector<Layer> layers, InnerSide side,
                                          const FaceProperties& face, double start_k,
                                          std::vector<double> knot_s, double tolerance_k,
                                          const Always& outside, const Always& inside = {}) {
  HeatRequest request;
  request.inner_side = side;
  request.knot_s = std::move(knot_s);
  request.outer = {face};
  if (side == InnerSide::kOpen) request.inner = {face};
  request.start = StatedStart{{start_k}, 0};
  for (std::size_t k = 1; k < request.knot_s.size(); ++k) request.output_knot.push_back(k);
  request.output_boundary = {0, layers.size()};
  request.layers = std::move(layers);
  request.accuracy = {tolerance_k, 8};
  const auto result =
      solve_heat(request, [&](std::size_t, std::span<const std::uint32_t>, const Exposure& to) {
        const auto set = [](const FaceExposure& at, const Always& what) {
          at.absorbed_w_m2[0] = what.absorbed_w_m2;
          at.incoming_w_m2[0] = what.incoming_w_m2;
          at.fluid_k[0] = what.fluid_k;
          at.forced_h_w_m2_k[0] = what.forced_h_w_m2_k;
        };
        set(to.outer_begin, outside);
        set(to.outer_end, outside);
        set(to.inner_begin, inside);
        set(to.inner_end, inside);
      });
  if (!result.ok()) return result.status();
  return result->temperature_k;
}

// Dark to both kinds of light: takes what it is given.
constexpr FaceProperties kTakesHeat{0, kForcedOnly};

// A thick wall that takes a constant flux, under a layer that stores nothing.
double half_space_k(double start_k, double flux_w_m2, const Layer& wall, const Layer& layer,
                    double time_s) {
  const double root =
      std::sqrt(wall.conductivity_w_m_k * wall.density_kg_m3 * wall.specific_heat_j_kg_k);
  return start_k + 2 * flux_w_m2 * std::sqrt(time_s / std::numbers::pi) / root +
         flux_w_m2 * layer.thickness_m / layer.conductivity_w_m_k;
}
constexpr Layer kPaint{1e-6, 0.2, 1400, 1500}, kConcrete{1, 1.4, 2300, 880},
    kSteel{0.008, 50, 7850, 460};

absl::StatusOr<Finding> thick_wall(double tolerance_k,
                                   std::initializer_list<std::pair<double, std::size_t>> steps) {
  Worst worst(1);
  for (const auto& [step_s, count] : steps) {
    const std::vector<double> knot_s = every(step_s, count);
    ASSIGN_OR_RETURN(const auto t, walls({kPaint, kConcrete}, InnerSide::kAdiabatic, kTakesHeat,
                                         290, knot_s, tolerance_k, {.absorbed_w_m2 = 500}));
    for (std::size_t k = 1; k < knot_s.size(); ++k) {
      const double expected = half_space_k(290, 500, kConcrete, kPaint, knot_s[k]);
      worst.see(std::abs(t[2 * (k - 1)] - expected) / tolerance_k, [&] {
        return absl::StrCat("after ", knot_s[k], " s: ", t[2 * (k - 1)], " K, expected ", expected);
      });
    }
  }
  return worst.finding();
}
absl::StatusOr<Finding> paint_on_concrete(Effort) { return thick_wall(2e-3, {{1800, 12}}); }
absl::StatusOr<Finding> step_lengths(Effort) { return thick_wall(5e-3, {{1, 120}, {3600, 6}}); }

// A layer without conduction separates two plates: one takes all the flux, the other none.
absl::StatusOr<Finding> no_conduction(Effort) {
  constexpr double kToleranceK = 5e-3, kFlux = 300;
  Worst worst(1);
  const std::vector<double> knot_s = every(3600, 6);
  const auto t = walls({kSteel, {0.1, 0, 60, 840}, kSteel}, InnerSide::kAdiabatic, kTakesHeat, 290,
                       knot_s, kToleranceK, {.absorbed_w_m2 = kFlux});
  if (!t.ok()) return t.status();
  const double stored = kSteel.thickness_m * kSteel.density_kg_m3 * kSteel.specific_heat_j_kg_k;
  for (std::size_t k = 1; k < knot_s.size(); ++k) {
    const double outer = 290 + kFlux * knot_s[k] / stored +
                         kFlux * kSteel.thickness_m / (3 * kSteel.conductivity_w_m_k);
    for (const auto& [value, expected] :
         {std::pair{(*t)[2 * (k - 1)], outer}, std::pair{(*t)[2 * k - 1], 290.0}})
      worst.see(std::abs(value - expected) / kToleranceK, [&, value = value, expected = expected] {
        return absl::StrCat("after ", knot_s[k], " s: ", value, " K, expected ", expected);
      });
  }
  return worst.finding();
}

// A foil that stores nothing, in still air under a cold sky, from any temperature: its balance.
absl::StatusOr<Finding> foil_in_a_calm_night(Effort) {
  constexpr double kToleranceK = 1e-3, kAirK = 288;
  Worst worst(1);
  for (const double emissivity : {0.03, 0.9})
    for (const double start_k : {250.0, 320.0}) {
      const FaceProperties face{emissivity, kMowitt};
      const Always up{0, 0.6 * black_w_m2(kAirK), kAirK, 0}, down{0, black_w_m2(285), kAirK, 0};
      const auto t = walls({{1e-5, 200, 2700, 900}}, InnerSide::kOpen, face, start_k,
                           every(3600, 3), kToleranceK, up, down);
      if (!t.ok()) return t.status();
      double low = 200, high = 320;
      for (int i = 0; i < 80; ++i) {
        const double mid = 0.5 * (low + high);
        const double heat =
            emissivity * (up.incoming_w_m2 + down.incoming_w_m2 - 2 * black_w_m2(mid)) -
            2 * 0.84 * std::cbrt(std::abs(mid - kAirK)) * (mid - kAirK);
        (heat > 0 ? low : high) = mid;
      }
      worst.see(std::abs(t->back() - low) / kToleranceK, [&] {
        return absl::StrCat("emissivity ", emissivity, ": ", t->back(), " K, expected ", low);
      });
    }
  return worst.finding();
}

// A plate so conducting that it has one temperature cools into nothing: T^-3 grows evenly.
absl::StatusOr<Finding> glowing_plates(Effort) {
  constexpr double kToleranceK = 0.02;
  Worst worst(1);
  const Layer plate{0.01, 1e9, 7850, 460};
  const double stored = plate.thickness_m * plate.density_kg_m3 * plate.specific_heat_j_kg_k;
  for (const double start_k : {400.0, 1500.0}) {
    const std::vector<double> knot_s = every(30, 20);
    ASSIGN_OR_RETURN(const auto t, walls({plate}, InnerSide::kAdiabatic, {1, kForcedOnly}, start_k,
                                         knot_s, kToleranceK, {}));
    for (std::size_t k = 1; k < knot_s.size(); ++k) {
      const double expected = std::pow(
          std::pow(start_k, -3) + 3 * kStefanBoltzmannWM2K4 * knot_s[k] / stored, -1.0 / 3);
      worst.see(std::abs(t[2 * (k - 1)] - expected) / kToleranceK, [&] {
        return absl::StrCat(start_k, " K after ", knot_s[k], " s: ", t[2 * (k - 1)],
                            " K, expected ", expected);
      });
    }
  }
  return worst.finding();
}

absl::StatusOr<Target> scene(const Mesh& mesh, std::vector<std::string> parts) {
  std::vector<PartSpec> specs;
  for (const std::string& name : parts) {
    specs.emplace_back();
    specs.back().name = name;
    specs.back().rest = parts.size() == 1;
  }
  return make_target(mesh, std::move(specs), widest_isa());
}

// So many hours of air that does not change, without sky or sun.
SceneHeatRequest still_air(double air_k, std::size_t hours) {
  SceneHeatRequest r;
  for (std::size_t k = 0; k <= hours; ++k) {
    r.knot_s.push_back(3600.0 * static_cast<double>(k));
    r.weather.push_back({air_k, 0, {1, 0, 0}, {0, 0, 1}, 0.0047, {0, 0, 0}, {0, 0, 0}});
  }
  r.day_knots = 24;
  r.output_knot = {0, hours / 2, hours};
  r.beneath.surface_z_m = INFINITY;
  WallBuildUp steel;
  steel.name = "steel";
  steel.layers = {{0.005, 45, 7850, 490}};
  r.build_up = {steel};
  return r;
}

absl::StatusOr<Finding> closed_box(Effort) {
  Worst worst(1e-3);
  ASSIGN_OR_RETURN(const auto mesh, generate_mesh({"box", 192, 0, 2, 1, 1}));
  ASSIGN_OR_RETURN(const auto target, scene(inside_out(mesh), {"box"}));
  for (const double emissivity : {0.05, 0.95}) {
    SceneHeatRequest r = still_air(300, 240);
    r.part = {{0.5, emissivity, 0u, 0}};
    r.exchange_tolerance_k = 1e-3;
    ASSIGN_OR_RETURN(const auto result, solve_scene_heat(target, r));
    for (const auto& at : result.kelvin)
      for (const float kelvin : at)
        worst.see(std::abs(static_cast<double>(kelvin) - 300),
                  [&] { return absl::StrCat("emissivity ", emissivity, ": ", kelvin, " K"); });
  }
  return worst.finding();
}

// A sphere in a sphere, both bright: what the outer one passes on to 300 K behind it is what the
// inner one loses.
absl::StatusOr<Finding> bright_enclosure(Effort) {
  constexpr double kEmissivity = 0.05, kHotK = 400, kBehindK = 300, kPasses = 10;
  Worst worst(5e-4);
  ASSIGN_OR_RETURN(auto inner, generate_mesh({"sphere", 400, 1, 0, 0, 0}));
  ASSIGN_OR_RETURN(auto outer, generate_mesh({"sphere", 400, 2, 0, 0, 0}));
  inner.group = {"inner"};
  inner.triangle_group.assign(inner.triangle.size(), 0);
  outer.group = {"outer"};
  outer.triangle_group.assign(outer.triangle.size(), 0);
  ASSIGN_OR_RETURN(const auto target,
                   scene(joined(inner, inside_out(outer), ""), {"inner", "outer"}));
  SceneHeatRequest r = still_air(kBehindK, 24);
  r.build_up[0].layers = {{1e-3, 1e-3 * kPasses, 1000, 1000}};
  r.build_up[0].inner_side = InnerSide::kFixedTemperature;
  r.build_up[0].inner_k = kBehindK;
  r.part = {{0.5, kEmissivity, std::nullopt, kHotK}, {0.5, kEmissivity, 0u, 0}};
  r.tolerance_k = 1e-4;
  r.exchange_tolerance_k = 1e-4;
  ASSIGN_OR_RETURN(const auto result, solve_scene_heat(target, r));
  const ThermalFaces faces = make_thermal_faces(target);
  double passed_w = 0, mean_k4 = 0;
  for (std::size_t f = 0; f < target.facet.size(); ++f) {
    if (target.facet[f].part != 1) continue;
    const auto t = static_cast<double>(result.kelvin[2][f]);
    const Convection c = tarp_natural(-static_cast<double>(target.facet[f].nz));
    const double above = t - kBehindK,
                 h = (above > 0 ? c.natural_warm : c.natural_cold) * std::cbrt(std::abs(above));
    const double area = faces.area_m2[f];
    passed_w += area * (kPasses + h) * above;
    mean_k4 += area / target.part_area_m2[1] * std::pow(t, 4);
  }
  const double a1 = target.part_area_m2[0], a2 = target.part_area_m2[1];
  const double expected = kStefanBoltzmannWM2K4 * (std::pow(kHotK, 4) - mean_k4) /
                          (1 / (kEmissivity * a1) + (1 / kEmissivity - 1) / a2);
  worst.see(std::abs(passed_w / expected - 1),
            [&] { return absl::StrCat(passed_w, " W, expected ", expected); });
  return worst.finding();
}

// A box under a sun that never rises, never sets, and rolls along the horizon. No face is colder
// than the coldest or warmer than the warmest of what it exchanges heat with.
absl::StatusOr<Finding> polar_days(Effort) {
  Worst worst(0.02);
  ASSIGN_OR_RETURN(const auto mesh, generate_mesh({"box", 48, 0, 0, 0, 0}));
  ASSIGN_OR_RETURN(const auto target, scene(mesh, {"box"}));
  struct Case {
    const char* name;
    double latitude_deg;
    int month, day;
    bool up, down;  // may the sun be
  };
  for (const Case& c :
       {Case{"polar night", 80, 12, 21, false, true}, Case{"polar day", 80, 6, 21, true, false},
        Case{"sun on the horizon", 90, 3, 20, true, true}}) {
    const double midnight_s = solar_midnight_unix_s(2025, c.month, c.day, 0);
    ASSIGN_OR_RETURN(const auto course,
                     day_course({255, 260, 14, 250, 101300, 3, 90, 0}, midnight_s));
    ASSIGN_OR_RETURN(const auto light,
                     CourseRadiation::make(course, {c.latitude_deg, 0, 0}, {0.1, 0.08, 0.3, 0.5}));
    SceneHeatRequest r = still_air(255, 24);
    r.knot_s = every(1800, 48);
    r.weather.clear();
    double warmest_k = 255, coldest_k = 255;
    for (double& knot_s : r.knot_s) {
      knot_s += midnight_s;
      const Radiation at = light.at(knot_s);
      const double sun_w_m2 = at.direct_normal_w_m2, sky_w_m2 = at.diffuse_horizontal_w_m2;
      const auto where = [&] {
        return absl::StrCat(c.name, ", ", (knot_s - midnight_s) / 3600, " h: sun ", sun_w_m2,
                            ", sky ", sky_w_m2, " W/m2");
      };
      worst.require(std::isfinite(sun_w_m2) && sun_w_m2 >= 0 && sun_w_m2 < 1361 * 1.035, where);
      worst.require(std::isfinite(sky_w_m2) && sky_w_m2 >= 0 && sky_w_m2 < 1361 * 1.035, where);
      worst.require(c.up || (sun_w_m2 == 0 && sky_w_m2 == 0), where);
      worst.require(c.down || sun_w_m2 > 0, where);
      const double air_k = weather_at(course, knot_s).air_k;
      const HeatRadiation both{sun_w_m2, sky_w_m2, at.sky_w_m2};
      r.weather.push_back({air_k,
                           3,
                           {0, 1, 0},
                           body_from_enu(light.sun_at(knot_s).direction, 0),
                           0.0047,
                           both,
                           both});
      // All that could arrive, on a face that sees sun, sky and what they light below whole; as
      // much of light and of heat is absorbed.
      const double most = 1.5 * (sun_w_m2 + sky_w_m2) + black_w_m2(262);
      warmest_k = std::max({warmest_k, air_k, std::pow(most / kStefanBoltzmannWM2K4, 0.25)});
      coldest_k = std::min({coldest_k, air_k, std::pow(at.sky_w_m2 / kStefanBoltzmannWM2K4, 0.25)});
    }
    r.day_knots = 48;
    r.output_knot.clear();
    for (std::size_t k = 0; k <= 48; k += 2) r.output_knot.push_back(k);
    r.part = {{0.9, 0.9, 0u, 0}};
    r.beneath = {.surface_z_m = 5, .temperature_k = 258, .emissivity = 1, .solar_albedo = 0.5};
    ASSIGN_OR_RETURN(const auto result, solve_scene_heat(target, r));
    for (const auto& at : result.kelvin)
      for (const float kelvin : at) {
        const auto t = static_cast<double>(kelvin);
        worst.see(std::max({0.0, t - warmest_k, coldest_k - t}), [&] {
          return absl::StrCat(c.name, ": ", t, " K, outside of ", coldest_k, " to ", warmest_k);
        });
        worst.require(std::isfinite(t), [&] { return absl::StrCat(c.name, ": ", t, " K"); });
      }
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> heat_cases() {
  return {
      {"heat", "paint_on_concrete",
       "1 um of paint on 1 m of concrete in a constant flux, 6 h: face, in tolerances of 2 mK",
       "the half-space's closed form; what the paint stores is 4e-6 of the heat",
       paint_on_concrete},
      {"heat", "step_lengths", "the same with knots every 1 s and every 1 h, in tolerances of 5 mK",
       "the same: 1 m of concrete is a half-space for a day", step_lengths},
      {"heat", "no_conduction",
       "steel, a layer with k = 0, steel: both faces, in tolerances of 5 mK",
       "q t / C + q d / (3 k) of a plate that gives nothing on; the other one stays as it is",
       no_conduction},
      {"heat", "foil_in_a_calm_night",
       "10 um of aluminium in still air under a cold sky: in tolerances of 1 mK",
       "what stores nothing has the temperature of its balance, here by bisection",
       foil_in_a_calm_night},
      {"heat", "glowing_plates", "plates of 400 and 1500 K that cool: in tolerances of 20 mK",
       "C dT/dt = -sigma T^4 has the solution T^-3 = T0^-3 + 3 sigma t / C", glowing_plates},
      {"heat", "closed_box",
       "10 days in a box that sees no sky, emissivity 0.05 and 0.95, air as warm as it: change [K]",
       "nothing flows; rounding and what exchange may leave are 1 mK", closed_box},
      {"heat", "bright_enclosure",
       "400 K in a sphere before 300 K, both of emissivity 0.05: heat, relative",
       "diffuse grey concentric bodies' closed form; shares of 4 % of the resistance are known to "
       "0.3 "
       "% (256 rays of 400 facets), and floats of 300 K, averaged, give 2e-5 of the flux",
       bright_enclosure},
      {"heat", "polar_days",
       "sun that never rises, never sets, rolls along the horizon: beyond the extremes [K]",
       "heat flows from warm to cold: no face leaves the range of what it exchanges heat with, but "
       "for the tolerance of exchange and conduction",
       polar_days},
  };
}

}  // namespace irsig
