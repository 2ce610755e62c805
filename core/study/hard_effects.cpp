// The cells of the matrix of effects that are made to deceive whoever leaves effects out.
#include <cmath>
#include <utility>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/geo/frames.h"
#include "core/study/effects_matrix.h"
#include "core/study/matrix_bodies.h"
#include "core/study/matrix_worlds.h"

namespace irsig {
namespace {

constexpr double kKm = 1000;

MatrixCell cell(std::string name, std::string why, Mesh mesh, Band band, WeatherSpec weather,
                std::vector<double> part_temperature_k) {
  MatrixCell out;
  out.name = std::move(name);
  out.why = std::move(why);
  out.scene.mesh = std::move(mesh);
  out.scene.band = {std::move(band)};
  out.weather = std::move(weather);
  out.condition = condition_over(out.weather, std::move(part_temperature_k));
  return out;
}

void all_of(MatrixCell& c, MaterialSpec material) {
  c.scene.material = {std::move(material)};
  c.scene.part = {{"target", {"*"}, 0, false, false}};
}

// 1e-4 of the 164 m2 of its box.
constexpr HalfSize kHull{5, 2, 1.5};
constexpr double kHalfSpotM = 0.064;

MatrixCell hot_spot_seen(bool marked) {
  const Mesh mesh = shifted(block_with_spot(kHull, kHalfSpotM), {0, 0, -2});
  MatrixCell c = cell(marked ? "hot spot seen" : "hot spot seen, not marked",
                      "1500 K on 1e-4 of a cold body's area, half of the viewpoints facing it",
                      mesh, mid_wave_band(), open_sea(), {290, 1500});
  c.scene.material = {matt_paint(0.9)};
  c.scene.part = {{"body", {}, 0, false, false}, {"spot", {}, 0, false, marked}};
  c.viewpoint = grid_of({{90, 10}, {270, 10}, {60, 30}, {200, 40}}, 5 * kKm);
  return c;
}

// A plate stands opposite the spot: seen from port over the hull, it mirrors what faces away.
absl::StatusOr<MatrixCell> hot_spot_mirrored() {
  ASSIGN_OR_RETURN(auto metal, bare_aluminium());
  const Mesh plate = shifted(with_group(block({5, 0.1, 4}), "plate"), {0, 6.1, -4.5});
  const Mesh mesh = together(shifted(block_with_spot(kHull, kHalfSpotM), {0, 0, -2}), plate);
  MatrixCell c =
      cell("hot spot in a mirror", "the same spot, seen only as a rough metal plate reflects it",
           mesh, mid_wave_band(), open_sea(), {290, 1500, 290});
  c.scene.material = {matt_paint(0.9), std::move(metal)};
  c.scene.part = {
      {"body", {}, 0, false, false}, {"spot", {}, 0, false, true}, {"plate", {}, 1, false, false}};
  c.viewpoint = grid_of({{270, 20}, {250, 20}, {290, 12}, {300, 35}}, 5 * kKm);
  return c;
}

// A flank of slope 0.01 that mirrors the sun into the first viewpoint; the second is 2.5 deg
// beside, the third 8 deg.
absl::StatusOr<MatrixCell> glint() {
  ASSIGN_OR_RETURN(auto metal, bare_aluminium(0.01));
  const double tilt_deg = 25, seen_deg = 10;
  const Mesh mesh = shifted(tilted(block_with_mirror({5, 0.3, 2}), tilt_deg), {0, 0, -4});
  MatrixCell c = cell("glint", "a mirror flank throws the sun into one viewpoint", mesh,
                      mid_wave_band(), open_sea(), {290, 290});
  c.scene.material = {matt_paint(0.9), std::move(metal)};
  c.scene.part = {{"body", {}, 0, false, false}, {"mirror", {}, 1, false, false}};
  add_sun(c.condition, 90, 2 * tilt_deg - seen_deg);
  c.viewpoint = grid_of({{90, seen_deg}, {92.5, seen_deg}, {90, 18}, {270, 30}}, 5 * kKm);
  return c;
}

// A patch of that mirror on a hot body: nearly as bright as what may be left out, and the bound of
// a mirror that throws all of the sun's disk at the sensor has no room to spare.
absl::StatusOr<MatrixCell> faint_glint() {
  ASSIGN_OR_RETURN(auto metal, bare_aluminium(0.01));
  const double tilt_deg = 25, seen_deg = 10;
  const Mesh mesh = shifted(tilted(block_with_spot({5, 0.3, 2}, 0.15), tilt_deg), {0, 0, -4});
  MatrixCell c = cell("faint glint", "a mirror of 0.09 m2 glints from a flank of 900 K", mesh,
                      mid_wave_band(), open_sea(), {900, 290});
  c.scene.material = {matt_paint(0.995), std::move(metal)};
  // Rays of its own, so that its part is known well.
  c.scene.part = {{"body", {}, 0, false, false}, {"spot", {}, 1, false, true}};
  add_sun(c.condition, 90, 2 * tilt_deg - seen_deg);
  c.viewpoint = grid_of({{90, seen_deg}, {92.5, seen_deg}, {90, 18}, {270, 30}}, 5 * kKm);
  return c;
}

MatrixCell deep_cavity() {
  const Mesh mesh = shifted(bay({8, 3, 3}, {6, 2, 2}, {0.6, 0, 0.6}), {0, 0, -4});
  MatrixCell c = cell("deep cavity",
                      "white walls of 700 K behind an opening of 0.6 % of their area: a tenth of "
                      "the light is reflected more than 20 times",
                      mesh, mid_wave_band(), open_sea(), {290, 700});
  c.scene.material = {matt_paint(0.9), matt_paint(0.1)};
  c.scene.part = {{"outside", {}, 0, false, false}, {"inside", {}, 1, false, false}};
  c.viewpoint = grid_of({{90, 3}, {75, 20}, {120, 10}, {60, 40}}, 5 * kKm);
  c.max_reflections = 100;
  return c;
}

MatrixCell crossover() {
  WeatherSpec land = bare_land();
  MatrixCell c =
      cell("thermal crossover",
           "within 0.1 K of what it is seen against: brighter from some sides, darker from others",
           shifted(block({5, 2, 1.5}), {0, 0, -2}), long_wave_band(), land,
           {land.lower.temperature_k - 0.15});
  all_of(c, matt_paint(land.lower.emissivity));
  c.viewpoint = grid_of({{90, 80}, {45, 60}, {180, 40}, {300, 25}}, 0.5 * kKm);
  return c;
}

absl::StatusOr<MatrixCell> low_sun(bool mirror) {
  MatrixCell c = cell(mirror ? "low sun on metal" : "low sun", "the sun 1 deg above the sea",
                      shifted(drum(3, 16), {0, 0, -4}), mid_wave_band(), open_sea(), {290});
  ASSIGN_OR_RETURN(auto metal, bare_aluminium());
  all_of(c, mirror ? std::move(metal) : matt_paint(0.9));
  add_sun(c.condition, 60, 1);
  c.viewpoint = grid_of({{90, 5}, {245, 2}, {60, 15}, {200, 40}}, 5 * kKm);
  return c;
}

// Seen from below: the sensor is 13 m above the sea, the target 56 to 64 m.
MatrixCell before_the_sky() {
  MatrixCell c = cell("before the sky", "a cold target above the sensor, by day",
                      shifted(drum(3, 16), {0, 0, -60}), mid_wave_band(), open_sea(), {270});
  all_of(c, matt_paint(0.9));
  c.target_height_m = 60;
  add_sun(c.condition, 130, 35);
  c.viewpoint = grid_of({{90, 0.03}, {310, 0.03}, {130, 0.03}, {0, 0.03}}, 10 * kKm);
  return c;
}

MatrixCell outshines() {
  MatrixCell c = cell("outshines", "a body of 1200 K whose reflections are all negligible, by day",
                      shifted(bay({8, 3, 3}, {6, 2, 2}, {6, 0, 2}), {0, 0, -4}), mid_wave_band(),
                      open_sea(), {1200, 1200});
  c.scene.material = {matt_paint(0.97)};
  c.scene.part = {{"outside", {}, 0, false, false}, {"inside", {}, 0, false, false}};
  add_sun(c.condition, 130, 35);
  c.viewpoint = grid_of({{100, 5}, {75, 25}, {200, 10}, {320, 50}}, 5 * kKm);
  return c;
}

MatrixCell black_in_fog() {
  MatrixCell c = cell("black in fog", "a blackbody as warm as fog of 300 m visibility, by day",
                      shifted(drum(3, 16), {0, 0, -4}), mid_wave_band(), sea_fog(300), {294});
  all_of(c, matt_paint(1));
  add_sun(c.condition, 130, 35);
  c.viewpoint = grid_of({{100, 5}, {75, 25}, {200, 10}, {320, 50}}, 0.5 * kKm);
  return c;
}

// Gloss seen at 85 deg towards the sun.
absl::StatusOr<MatrixCell> grazing_gloss(double slope) {
  ASSIGN_OR_RETURN(auto metal, bare_aluminium(slope));
  MatrixCell c = cell(slope < 0.2 ? "grazing gloss" : "grazing rough gloss",
                      "a metal deck seen at 84 to 88 deg, the sun opposite and low",
                      shifted(block({5, 2, 0.1}), {0, 0, -4}), mid_wave_band(), open_sea(), {290});
  all_of(c, std::move(metal));
  add_sun(c.condition, 180, 6);
  c.viewpoint = grid_of({{0, 5}, {0, 2}, {3, 6}, {180, 5}}, 5 * kKm);
  return c;
}

MatrixCell hole() {
  MatrixCell c = cell("hot behind a hole", "700 K in a bay behind 4e-3 of the hull's flank",
                      shifted(bay({8, 3, 3}, {6, 2, 2}, {0.3, 0, 0.3}), {0, 0, -4}),
                      mid_wave_band(), open_sea(), {290, 700});
  c.scene.material = {matt_paint(0.9)};
  c.scene.part = {{"outside", {}, 0, false, false}, {"inside", {}, 0, false, true}};
  c.viewpoint = grid_of({{90, 3}, {75, 20}, {120, 10}, {60, 40}}, 5 * kKm);
  return c;
}

// A level mirror throws the sun up and to port, where another sends it back to starboard.
absl::StatusOr<MatrixCell> two_mirrors() {
  ASSIGN_OR_RETURN(auto metal, bare_aluminium(0.02));
  const double sun_deg = 40, seen_deg = 10, aside_m = 6;
  const double up_m = aside_m * std::tan(sun_deg * kRadPerDeg);
  const Mesh mesh =
      together(shifted(with_group(block({0.5, 0.5, 0.1}), "level"), {0, 0, -4}),
               shifted(tilted(block_with_mirror({0.5, 0.1, 0.5}), 0.5 * (seen_deg - sun_deg)),
                       {0, -aside_m, -4.1 - up_m}));
  MatrixCell c = cell("two mirrors", "sunlight reaches one viewpoint by way of two mirrors", mesh,
                      mid_wave_band(), open_sea(), {290, 290, 290});
  c.scene.material = {matt_paint(0.9), std::move(metal)};
  c.scene.part = {{"body", {}, 0, false, false},
                  {"mirror", {}, 1, false, false},
                  {"level", {}, 1, false, false}};
  add_sun(c.condition, 90, sun_deg);
  c.viewpoint = grid_of({{90, seen_deg}, {91, seen_deg}, {90, 20}, {270, 30}}, 5 * kKm);
  return c;
}

MatrixCell notch() {
  MatrixCell c = cell("notch", "emissivity 0.1 within a tenth of the band's step, by day",
                      shifted(drum(3, 16), {0, 0, -4}), mid_wave_band(), open_sea(), {300});
  all_of(c, {"paint",
             Lambert{{{2, 0.9}, {3.92, 0.9}, {3.921, 0.1}, {3.929, 0.1}, {3.93, 0.9}, {15, 0.9}}}});
  add_sun(c.condition, 130, 35);
  c.viewpoint = grid_of({{100, 5}, {75, 25}, {200, 10}, {320, 50}}, 5 * kKm);
  return c;
}

}  // namespace

absl::StatusOr<std::vector<MatrixCell>> hard_cells() {
  std::vector<MatrixCell> out;
  for (absl::StatusOr<MatrixCell> made :
       {absl::StatusOr<MatrixCell>(hot_spot_seen(true)),
        absl::StatusOr<MatrixCell>(hot_spot_seen(false)), hot_spot_mirrored(), glint(),
        faint_glint(), absl::StatusOr<MatrixCell>(deep_cavity()),
        absl::StatusOr<MatrixCell>(crossover()), low_sun(false), low_sun(true),
        absl::StatusOr<MatrixCell>(before_the_sky()), absl::StatusOr<MatrixCell>(outshines()),
        absl::StatusOr<MatrixCell>(black_in_fog()), grazing_gloss(0.04), grazing_gloss(0.3),
        absl::StatusOr<MatrixCell>(hole()), two_mirrors(), absl::StatusOr<MatrixCell>(notch())}) {
    if (!made.ok()) return made.status();
    out.push_back(*std::move(made));
  }
  return out;
}

}  // namespace irsig
