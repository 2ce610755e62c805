// Rationale: the stated error of a computed temperature covers what it is off by, in weather that
// jumps at records (means over hours), that bends every few minutes (broken cloud), and for facets
// at any tilt whose share of the sky is known by a closed form. Expected: no temperature beyond 5
// stated errors; root mean square of off / stated at least 0.1 and at most 1.3 in each family: far
// too wide is wrong, too. Source: CVODE for walls (tests/physics/cvode_wall.h), and below the
// weather between records, sky and ground by closed forms; shared with the program are the
// correlations of convection and the place of the sun, which other tests hold.
// docs/evidence/stability.md, "Computed temperatures", has 200 seeds (IRSIG_HEAT_SEEDS=200).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/constants.h"
#include "core/geo/sun.h"
#include "core/thermal/convection.h"
#include "core/thermal/scene/scene_heat.h"
#include "runner/heat_weather.h"
#include "tests/honesty/random.h"
#include "tests/physics/cvode_wall.h"
#include "tests/physics/heat_scene.h"

namespace irsig {
namespace {

constexpr double kHourS = 3600, kDayS = 86400;
constexpr double kLatitudeDeg = 45, kLongitudeDeg = 0;

double power4(double t) { return t * t * t * t; }

int seeds() {
  const char* asked = std::getenv("IRSIG_HEAT_SEEDS");
  return asked != nullptr ? std::max(1, std::atoi(asked)) : 20;
}

struct Record {
  double unix_s, air_k, wind_m_s, direct, diffuse, sky;
};

struct Scene {
  Mesh mesh;
  std::vector<Vec<Body>> normal;  // [facet] outwards
  bool two_sided = false;
  WallBuildUp wall;
  std::vector<Record> record;
  double interval_s = 0;  // radiation is the mean over so long before; 0: of the instant
  double wind_from_deg = 0;
  double absorptance = 0.5, emissivity = 0.9;
  double ground_k = 289, ground_emissivity = 0.95, albedo = 0.2;
  std::vector<double> asked_s;  // increasing
};

// Returns the unit vector towards the sun; below the horizon in every case where there is no sun.
// Nine tenths of the test's time were spent here: each time of a day is computed once, for all days
// that a reference goes through and all scenes.
Vec<Enu> sun_at(double unix_s) {
  static std::unordered_map<double, Vec<Enu>> known;
  const auto [at, fresh] = known.try_emplace(unix_s, Vec<Enu>{0, 0, -1});
  if (!fresh) return at->second;
  const auto sun = sun_position(utc_time(unix_s), kLatitudeDeg, kLongitudeDeg, 0);
  if (sun.ok()) at->second = sun->direction;
  return at->second;
}
double sine_of_sun(double unix_s) { return sun_at(unix_s).z; }
Vec<Body> to_sun(double unix_s) { return body_from_enu(sun_at(unix_s), 0); }

// The weather of a scene between two records, by arithmetic of its own.
class Sky {
 public:
  explicit Sky(const Scene& scene) : scene_(scene) {
    constexpr int kPieces = 720;
    for (const Record& r : scene.record) {
      double up = 0, twilight = 0;
      for (int i = 0; scene.interval_s > 0 && r.direct + r.diffuse > 0 && i < kPieces; ++i) {
        const double s = sine_of_sun(r.unix_s - scene.interval_s * (i + 0.5) / kPieces);
        up += (s > 0 ? 1.0 : 0.0) / kPieces;
        twilight += std::max(0.0, s + std::sin(6 * kRadPerDeg)) / kPieces;
      }
      direct_.push_back(up > 0 ? r.direct / up : 0);
      diffuse_.push_back(twilight > 0 ? r.diffuse / twilight : 0);
    }
  }

  // Returns the weather at any instant of the interval that ends with a record.
  [[nodiscard]] wall::Weather at(std::size_t upper, double t, Vec<Body> normal) const {
    const Record &a = scene_.record[upper - 1], &b = scene_.record[upper];
    const double f = (t - a.unix_s) / (b.unix_s - a.unix_s), sine = sine_of_sun(t);
    const auto line = [&](double Record::*value) { return (1 - f) * a.*value + f * b.*value; };
    const bool mean = scene_.interval_s > 0;
    const double direct = sine > 0 ? (mean ? direct_[upper] : line(&Record::direct)) : 0,
                 diffuse = mean ? diffuse_[upper] * std::max(0.0, sine + std::sin(6 * kRadPerDeg))
                                : line(&Record::diffuse),
                 sky = mean ? b.sky : line(&Record::sky), air = line(&Record::air_k),
                 wind = line(&Record::wind_m_s);
    const double up = -normal.z, of_sky = 0.5 * (1 + up), of_ground = 1 - of_sky,
                 cosine = std::max(0.0, dot(normal, to_sun(t))),
                 ground =
                     scene_.ground_emissivity * kStefanBoltzmannWM2K4 * power4(scene_.ground_k) +
                     (1 - scene_.ground_emissivity) * sky;
    const double turn = scene_.wind_from_deg * kRadPerDeg;
    const bool windward = normal.x * std::cos(turn) + normal.y * std::sin(turn) > -1e-6;
    return {
        scene_.absorptance * (direct * cosine + diffuse * of_sky +
                              scene_.albedo * (diffuse + direct * std::max(0.0, sine)) * of_ground),
        of_sky * sky + of_ground * ground, air,
        mowitt_forced_w_m2_k(wind, windward ? WindSide::kWindward : WindSide::kLeeward)};
  }

 private:
  const Scene& scene_;
  std::vector<double> direct_, diffuse_;  // [record]
};

// Returns the temperature of a facet's front at the times asked for. A computed temperature stands
// for both sides of a sheet, and its error covers either.
std::vector<double> reference_k(const Scene& scene, const Sky& sky, std::size_t facet) {
  const Vec<Body> front = scene.normal[facet], back = -1.0 * front;
  const bool open = scene.wall.inner_side == InnerSide::kOpen;
  const auto face = [&](Vec<Body> n) {
    wall::CvodeWall::Face out{};
    Convection air = tarp_natural(-n.z);
    air.mixing = 0;
    out.properties = {scene.emissivity, air};
    return out;
  };
  wall::CvodeWall::Face outer = face(front), inner{};
  if (open) inner = face(back);
  inner.begin.forced_h_w_m2_k = inner.end.forced_h_w_m2_k = 0;
  const double begin_s = scene.record.front().unix_s, last_s = scene.asked_s.back();
  std::vector<double> cut;
  for (const Record& r : scene.record) cut.push_back(r.unix_s);
  for (const double t : scene.asked_s) cut.push_back(t);
  constexpr double kPieceS = 300;
  for (double t = begin_s; t < last_s; t += kPieceS) cut.push_back(t);
  for (double t = begin_s; t < last_s; t += kPieceS) {  // sunrise and sunset
    double low = t, high = t + kPieceS;
    if ((sine_of_sun(low) > 0) == (sine_of_sun(high) > 0)) continue;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      ((sine_of_sun(middle) > 0) == (sine_of_sun(t) > 0) ? low : high) = middle;
    }
    cut.push_back(low);
    cut.push_back(high);
  }
  std::sort(cut.begin(), cut.end());
  wall::CvodeWall wall(scene.wall.layers, 6, false, scene.record.front().air_k);
  std::array<double, 2> t{};
  const auto go = [&](double from_s, double to_s, std::vector<double>* out) {
    double now = from_s;
    std::size_t upper = 1, next = 0;
    const auto note = [&] {
      while (out != nullptr && next < scene.asked_s.size() && scene.asked_s[next] <= now + 1e-6) {
        out->push_back(t[0]);
        ++next;
      }
    };
    for (const double end : cut) {
      if (end <= from_s + 1e-7 || end - now < 1e-7) continue;
      if (end > to_s + 1e-6) break;
      while (scene.record[upper].unix_s <= 0.5 * (now + end)) ++upper;
      // Sides of sunrise and sunset: just within the piece.
      const double in = 1e-6 * (end - now);
      outer.begin = sky.at(upper, now + in, front);
      outer.end = sky.at(upper, end - in, front);
      if (open) {
        inner.begin = sky.at(upper, now + in, back);
        inner.end = sky.at(upper, end - in, back);
      } else if (scene.wall.inner_side == InnerSide::kAir) {
        inner.begin = inner.end = {0, 0, scene.wall.inner_k, scene.wall.inner_h_w_m2_k};
      }
      t = wall.advance(outer, inner, end - now);
      now = end;
      note();
    }
  };
  double before = 0;
  for (int day = 0; day < 30; ++day) {
    go(begin_s, begin_s + kDayS, nullptr);
    if (day > 0 && std::abs(t[0] - before) < 1e-4) break;
    before = t[0];
  }
  std::vector<double> out;
  go(begin_s + kDayS, last_s, &out);
  EXPECT_EQ(out.size(), scene.asked_s.size());
  return out;
}

absl::StatusOr<SceneHeatResult> computed(const Scene& scene, std::uint64_t seed) {
  schema::Sweep sweep;
  sweep.mutable_place()->set_latitude_deg(kLatitudeDeg);
  sweep.mutable_place()->set_longitude_deg(kLongitudeDeg);
  sweep.mutable_heat()->set_step_minutes(10);
  schema::HeatRun run;
  for (const double t : scene.asked_s) run.add_time_utc(format_rfc3339_utc(utc_time(t)));
  run.mutable_weather()->set_profile("midlatitude_summer");
  run.mutable_weather()->set_aerosol("none");
  run.mutable_surroundings()->set_kind("ground");
  run.mutable_surroundings()->set_ground_temperature_k(scene.ground_k);
  run.mutable_surroundings()->set_ground_emissivity(scene.ground_emissivity);
  run.mutable_surroundings()->set_solar_albedo(scene.albedo);
  run.mutable_course()->set_radiation_interval_s(scene.interval_s);
  for (const Record& r : scene.record) {
    schema::WeatherRecord& to = *run.mutable_course()->add_record();
    to.set_unix_s(r.unix_s);
    to.set_air_temperature_k(r.air_k);
    to.set_dew_point_k(r.air_k - 8);
    to.set_pressure_pa(101300);
    to.set_wind_speed_m_s(r.wind_m_s);
    to.set_wind_from_deg(scene.wind_from_deg);
    to.set_direct_normal_w_m2(r.direct);
    to.set_diffuse_horizontal_w_m2(r.diffuse);
    to.set_sky_w_m2(r.sky);
  }
  auto knots = heat_weather(sweep, run);
  if (!knots.ok()) return knots.status();
  SceneHeatRequest request;
  request.part = {{scene.absorptance, scene.emissivity, 0u, 0}};
  request.build_up = {scene.wall};
  request.beneath = knots->beneath;
  request.beneath.surface_z_m = 1e6;
  request.knot_s = knots->knot_s;
  request.weather = knots->at;
  request.day_knots = knots->day_knots;
  request.output_knot = knots->output_knot;
  request.seed = seed;
  return solve_scene_heat(target_of(scene.mesh, {part("part", scene.two_sided)}), request);
}

Vec<Body> normal_of(const Mesh& mesh, std::size_t facet) {
  const auto& c = mesh.triangle[facet];
  return normalized(
      cross(mesh.vertex[c[1]] - mesh.vertex[c[0]], mesh.vertex[c[2]] - mesh.vertex[c[0]]));
}

WallBuildUp thin_wall(Random& random) {
  WallBuildUp out;
  out.name = "wall";
  const Layer steel{random.between(0.5e-3, 5e-3), 50, 7850, 460},
      aluminium{random.between(0.5e-3, 3e-3), 200, 2700, 900},
      glass{random.between(3e-3, 8e-3), 1, 2500, 800},
      wood{random.between(5e-3, 15e-3), 0.14, 550, 1600},
      wool{random.between(0.02, 0.06), 0.04, 60, 1000};
  const std::array<std::vector<Layer>, 5> stacks = {
      {{steel}, {aluminium}, {glass}, {wood}, {steel, wool}}};
  out.layers = stacks[random.below(stacks.size())];
  const std::size_t side = random.below(3);
  out.inner_side = side == 0   ? InnerSide::kAdiabatic
                   : side == 1 ? InnerSide::kAir
                               : InnerSide::kOpen;
  out.inner_k = random.between(285, 300);
  out.inner_h_w_m2_k = random.between(3, 12);
  return out;
}

// Adds a plate at a tilt: two triangles side by side, or one.
void add_plate(Random& random, Vec<Body> normal, bool pair, Mesh& mesh) {
  const Vec<Body> beside = normalized(cross(
                      normal, std::abs(normal.x) < 0.7 ? Vec<Body>{1, 0, 0} : Vec<Body>{0, 1, 0})),
                  above = cross(normal, beside);
  const double size = random.between(0.3, 3);
  mesh.group = {"part"};
  mesh.vertex = {{0, 0, 0}, size * beside, size * beside + size * above, size * above};
  mesh.triangle = {{0, 1, 2}};
  if (pair)
    mesh.triangle.push_back({0, 2, 3});
  else
    mesh.vertex.pop_back();
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
}

// Thin sheets and walls under a sky that jumps at records, with and without sunlight; asked at and
// around records.
Scene jumping(std::uint64_t seed) {
  Random random(1000 + seed);
  Scene s;
  s.wall = thin_wall(random);
  s.two_sided = s.wall.inner_side == InnerSide::kOpen;
  const Vec<Body> tilted = random.direction();
  add_plate(random, random.below(2) == 0 ? Vec<Body>{0, 0, -1} : tilted, true, s.mesh);
  s.interval_s = random.below(4) == 0 ? 1800 : kHourS;
  const double begin = unix_seconds(*parse_rfc3339("2025-06-20T00:00:00Z")),
               air = random.between(275, 300), swing = random.between(0, 6);
  const bool sunny = random.below(2) == 0;
  const int hours = 48;
  double sky = 330;
  for (int i = 0; i <= static_cast<int>(hours * kHourS / s.interval_s); ++i) {
    const double t = begin + i * s.interval_s, hour = (t - begin) / kHourS;
    Record r{t,
             air + swing * std::sin(2 * std::numbers::pi * (hour - 9) / 24),
             random.between(0.3, 5),
             0,
             0,
             0};
    if (random.below(3) == 0 || i == 0)
      sky = kStefanBoltzmannWM2K4 * power4(air) * random.between(0.6, 1.02);
    r.sky = sky;
    if (sunny && sine_of_sun(t) > 0.1 && sine_of_sun(t - s.interval_s) > 0.1) {
      r.direct = random.below(3) == 0 ? 0 : random.between(100, 900);
      r.diffuse = random.between(40, 300);
    }
    s.record.push_back(r);
  }
  s.wind_from_deg = random.between(0, 360);
  s.absorptance = random.between(0.2, 0.9);
  s.emissivity = random.between(0.5, 0.97);
  s.ground_k = air + random.between(-4, 8);
  const double hour = begin + kDayS + kHourS * static_cast<double>(2 + random.below(18));
  for (const double minutes : {0.0, -7.0, 3.0, 30.0, 60.0})
    s.asked_s.push_back(std::round(hour + 60 * minutes));
  s.asked_s.push_back(std::round(hour + random.between(4000, 9000)));
  std::sort(s.asked_s.begin(), s.asked_s.end());
  return s;
}

// Single triangles and small convex bodies at any tilt, in a smooth day of instants each hour.
Scene tilted(std::uint64_t seed) {
  Random random(2000 + seed);
  Scene s;
  s.wall = thin_wall(random);
  if (random.below(2) == 0) {
    s.two_sided = s.wall.inner_side == InnerSide::kOpen;
    add_plate(random, random.direction(), false, s.mesh);
  } else {
    if (s.wall.inner_side == InnerSide::kOpen) s.wall.inner_side = InnerSide::kAdiabatic;
    s.mesh.group = {"part"};
    std::array<Vec<Body>, 4> at{};
    do {
      for (Vec<Body>& v : at) v = random.between(0.4, 1.5) * random.direction();
    } while (std::abs(dot(at[1] - at[0], cross(at[2] - at[0], at[3] - at[0]))) < 0.3);
    if (dot(at[1] - at[0], cross(at[2] - at[0], at[3] - at[0])) > 0) std::swap(at[2], at[3]);
    s.mesh.vertex.assign(at.begin(), at.end());
    s.mesh.triangle = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    s.mesh.triangle_group.assign(4, 0);
  }
  const double begin = unix_seconds(*parse_rfc3339("2025-06-20T00:00:00Z")),
               air = random.between(275, 300), swing = random.between(1, 8),
               clear = random.between(0, 1), sky = random.between(0.65, 0.95),
               wind = random.between(0.5, 6);
  for (int hour = 0; hour <= 48; ++hour) {
    const double t = begin + hour * kHourS, sine = std::max(0.0, sine_of_sun(t)),
                 wave = std::sin(2 * std::numbers::pi * (hour - 9) / 24);
    const double air_k = air + swing * wave;
    s.record.push_back(
        {t, air_k, wind * (1 + 0.3 * wave), sine > 0 ? clear * 900 * std::pow(sine, 0.3) : 0,
         sine > 0 ? 30 + 120 * sine : 0, sky * kStefanBoltzmannWM2K4 * power4(air_k)});
  }
  s.wind_from_deg = random.between(0, 360);
  s.absorptance = random.between(0.2, 0.9);
  s.emissivity = random.between(0.5, 0.97);
  s.ground_k = air + random.between(-4, 8);
  for (int i = 0; i < 4; ++i)
    s.asked_s.push_back(std::round(begin + kDayS + random.between(0, 23.9) * kHourS));
  std::sort(s.asked_s.begin(), s.asked_s.end());
  return s;
}

// Sheets under broken cloud: instants every 10 minutes, the sun there or not.
Scene broken_cloud(std::uint64_t seed) {
  Random random(3000 + seed);
  Scene s;
  s.wall = thin_wall(random);
  s.two_sided = s.wall.inner_side == InnerSide::kOpen;
  const Vec<Body> any = random.direction();
  add_plate(random, {any.x, any.y, -std::abs(any.z)}, true, s.mesh);
  const double begin = unix_seconds(*parse_rfc3339("2025-06-20T00:00:00Z")),
               air = random.between(280, 300);
  for (int i = 0; i <= 288; ++i) {
    const double t = begin + 600.0 * i, sine = std::max(0.0, sine_of_sun(t));
    const bool cloud = random.below(2) == 0;
    s.record.push_back({t, air, 3, sine > 0 && !cloud ? 900 * std::pow(sine, 0.3) : 0,
                        sine > 0 ? (cloud ? 60 + 250 * sine : 30 + 120 * sine) : 0,
                        kStefanBoltzmannWM2K4 * power4(air) * (cloud ? 0.92 : 0.75)});
  }
  s.wind_from_deg = random.between(0, 360);
  s.absorptance = random.between(0.3, 0.9);
  s.emissivity = random.between(0.5, 0.97);
  s.ground_k = air;
  for (int i = 0; i < 4; ++i)
    s.asked_s.push_back(std::round(begin + kDayS + random.between(6, 18) * kHourS));
  std::sort(s.asked_s.begin(), s.asked_s.end());
  s.asked_s.erase(std::unique(s.asked_s.begin(), s.asked_s.end()), s.asked_s.end());
  return s;
}

void judge(const char* family, const std::function<Scene(std::uint64_t)>& scene_of,
           double most_stated_k) {
  double square = 0, count = 0, largest = 0, stated_sum = 0;
  std::vector<double> stated;
  int beyond = 0;
  for (int seed = 1; seed <= seeds(); ++seed) {
    Scene scene = scene_of(static_cast<std::uint64_t>(seed));
    for (std::size_t f = 0; f < scene.mesh.triangle.size(); ++f)
      scene.normal.push_back(normal_of(scene.mesh, f));
    const auto result = computed(scene, static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(result.ok()) << family << " " << seed << ": " << result.status();
    const Sky sky(scene);
    double worst = 0, off_k = 0, error_k = 0;
    for (std::size_t f = 0; f < scene.normal.size(); ++f) {
      if (f > 0 && length(scene.normal[f] - scene.normal[0]) < 1e-9) continue;  // the same
      const std::vector<double> exact = reference_k(scene, sky, f);
      for (std::size_t o = 0; o < exact.size(); ++o) {
        const double error = static_cast<double>(result->error_k[o][f]),
                     off = static_cast<double>(result->kelvin[o][f]) - exact[o], z = off / error;
        square += z * z;
        count += 1;
        stated.push_back(error);
        stated_sum += error;
        if (std::abs(z) > std::abs(worst)) {
          worst = z;
          off_k = off;
          error_k = error;
        }
        beyond += std::abs(z) > 5 ? 1 : 0;
      }
    }
    largest = std::max(largest, std::abs(worst));
    EXPECT_LT(std::abs(worst), 5) << family << ", seed " << seed << ": " << off_k
                                  << " K off, stated " << error_k;
    if (std::getenv("IRSIG_HEAT_SEEDS") != nullptr)
      std::printf("%s %d: z %.2f, off %.4f K, stated %.4f K\n", family, seed, worst, off_k,
                  error_k);
  }
  std::sort(stated.begin(), stated.end());
  const double rms = std::sqrt(square / count);
  std::printf(
      "%s: %.0f temperatures, rms z %.2f, largest %.2f, beyond 5: %d; stated %.4f K (median), %.3f "
      "K (95 %%)\n",
      family, count, rms, largest, beyond, stated[stated.size() / 2],
      stated[stated.size() * 95 / 100]);
  EXPECT_GT(rms, 0.2) << family;
  EXPECT_LT(rms, 1.3) << family;
  EXPECT_LT(stated[stated.size() * 95 / 100], most_stated_k) << family;
}

TEST(HeatErrors, SkiesThatJump) { judge("jumping sky", jumping, 6); }
TEST(HeatErrors, FacetsAtAnyTilt) { judge("any tilt", tilted, 3); }
TEST(HeatErrors, BrokenCloud) { judge("broken cloud", broken_cloud, 6); }

}  // namespace
}  // namespace irsig
