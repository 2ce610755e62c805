#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"
#include "verify/cases/small_bright_sources.h"
#include "verify/reference/reference_view.h"

namespace irsig {
namespace {

// Error bars on what is rare, tiny or hidden, against an integrator that aims at it
// (reference_view.h). The families are those of `irsig selftest --search`; here they stand alone,
// each with the numbers that once broke an error bar.

// The largest error of a row, in its own numerical errors and the reference's standard error.
absl::Status judge(const SceneSpec& scene, const ViewRequest& request, std::uint64_t samples,
                   const std::string& what, Worst& worst) {
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  ViewRequest asked = request;
  asked.selected_band.clear();
  for (std::uint32_t b = 0; b < scene.band.size(); ++b) asked.selected_band.push_back(b);
  asked.selected_condition = {0};
  ASSIGN_OR_RETURN(const auto view, simulator->simulate(asked));
  ASSIGN_OR_RETURN(const auto reference, ReferenceView::make(scene, asked, 0));
  const ReferenceView::Result truth = reference.run(samples, 7);
  for (std::size_t b = 0; b < view.row.size(); ++b) {
    const SignatureResult& row = view.row[b];
    const ReferenceView::Row& is = truth.row[b];
    struct Value {
      const char* name;
      double stated, error;
      const Estimate& is;
    };
    for (const Value& v :
         {Value{"total", row.intensity_w_sr.value, row.numerical_error_w_sr, is.total},
          Value{"apparent", row.apparent_intensity_w_sr.value, row.apparent_numerical_error_w_sr,
                is.apparent},
          Value{"contrast", row.contrast_intensity_w_sr.value, row.contrast_numerical_error_w_sr,
                is.contrast}}) {
      const double both = std::hypot(v.error, v.is.stderr_, 1e-6 * is.gross_w_sr);
      worst.see(std::abs(v.stated - v.is.value) / both, [&] {
        return absl::StrCat(what, ", ", scene.band[b].name, ", ", v.name, ": ", v.stated, " +- ",
                            v.error, ", reference ", v.is.value, " +- ", v.is.stderr_);
      });
    }
  }
  return absl::OkStatus();
}

Band mid_wave() { return {"MWIR", 3.5, 4.1, 0.2, {}}; }

MaterialSpec gloss(double slope) {
  CookTorrance m;
  m.constants = {{2, 1.5, 7}, {15, 1.5, 7}};
  m.roughness = slope;
  m.masking = Masking::kSmith;
  return {"gloss", m};
}

SceneSpec scene_of(Mesh mesh, std::vector<MaterialSpec> material) {
  SceneSpec scene;
  scene.mesh = std::move(mesh);
  scene.material = std::move(material);
  scene.band = {mid_wave()};
  return scene;
}

ViewRequest view_of(double elevation_deg, double range_m, std::vector<double> temperature_k) {
  ViewRequest r;
  r.viewpoint = {0, elevation_deg, range_m};
  ConditionSpec c;
  c.part_temperature_k = std::move(temperature_k);
  c.surroundings.sky_temperature_k = 220;
  r.condition = {c};
  r.max_reflections = 16;
  r.accuracy.relative_error = 0.02;
  r.accuracy.max_samples_per_replicate = 1 << 14;
  return r;
}

Vec<Body> sun_at(double azimuth_deg, double elevation_deg) {
  return body_from_aspect(azimuth_deg, elevation_deg);
}

// A deck of gloss, the sun on the other side, from glint to where the lobe ends.
absl::StatusOr<Finding> grazing_gloss(Effort effort) {
  Worst worst(student_t_bound(31, 54));
  for (const double slope : {0.04, 0.1, 0.3})
    for (const double incidence_deg : {80.0, 85.0, 89.0})
      for (const double off_deg : {0.0, 4.0}) {
        SceneSpec scene =
            scene_of(rectangle({0, 0, -1}, {1, 0, 0}, {0, -1, 0}, "deck"), {gloss(slope)});
        scene.part = {{"deck", {}, 0, true, false}};
        ViewRequest r = view_of(90 - incidence_deg, 1000, {290});
        put_sun(r.condition[0], sun_at(180, 90 - incidence_deg + off_deg));
        RETURN_IF_ERROR(
            judge(scene, r, effort == Effort::kFull ? 4096 : 512,
                  absl::StrCat("slope ", slope, ", ", incidence_deg, " deg, ", off_deg, " deg off"),
                  worst));
      }
  return worst.finding();
}

// A deck of gloss seen past the rim of the glint: the sun is nearly behind the target, so near that
// only a part of the deck shows it. The half vector is short there, and turns through many times
// the sun's radius.
absl::StatusOr<Finding> forward_glint(Effort effort) {
  Worst worst(student_t_bound(31, 36));
  for (const double slope : {0.02, 0.034, 0.1})
    for (const double range_m : {30.0, 145.0})
      for (const double off_deg : {0.0, 0.7}) {
        SceneSpec scene =
            scene_of(rectangle({0, 0, 0}, {1, 0, 0}, {0, -1, 0}, "deck"), {gloss(slope)});
        scene.part = {{"deck", {}, 0, true, false}};
        ViewRequest r = view_of(0.45, range_m, {275});
        put_sun(r.condition[0], sun_at(180 + off_deg, 0.52));
        RETURN_IF_ERROR(judge(
            scene, r, effort == Effort::kFull ? 65536 : 8192,
            absl::StrCat("slope ", slope, ", ", range_m, " m, ", off_deg, " deg off"), worst));
      }
  return worst.finding();
}

// A plate with a hole in its middle, and something hot behind it.
absl::StatusOr<Finding> hot_behind_a_hole(Effort effort) {
  Worst worst(student_t_bound(31, 12));
  for (const double half_m : {0.2, 0.05, 0.02, 0.005}) {
    const double inner = half_m, middle = 0.5 * (2 + inner), wide = 0.5 * (2 - inner);
    const auto piece = [&](double y, double z, double hy, double hz) {
      return rectangle({2, y, z}, {0, hy, 0}, {0, 0, hz}, "plate");
    };
    Mesh mesh = joined(piece(0, -middle, 2, wide), piece(0, middle, 2, wide), "b/");
    mesh = joined(mesh, piece(-middle, 0, wide, inner), "c/");
    mesh = joined(mesh, piece(middle, 0, wide, inner), "d/");
    mesh = joined(mesh, rectangle({1.5, 0, 0}, {0, 1, 0}, {0, 0, 1}, "hot"), "e/");
    SceneSpec scene = scene_of(mesh, {grey_paint(0.9)});
    scene.part = {{"plate", {"plate", "*/plate"}, 0, true, false},
                  {"hot", {"*/hot"}, 0, true, true}};
    RETURN_IF_ERROR(judge(scene, view_of(5, 1000, {290, 1200}),
                          effort == Effort::kFull ? 65536 : 8192,
                          absl::StrCat("hole of ", 2 * half_m, " m"), worst));
  }
  return worst.finding();
}

// A small mirror before a large matt plate, at and beside the direction in which it shows the sun.
absl::StatusOr<Finding> small_mirror(Effort effort) {
  Worst worst(student_t_bound(31, 36));
  const Vec<Body> sun = sun_at(20, 45), eye = body_from_aspect(0, 5);
  for (const double slope : {0.003, 0.02, 0.1})
    for (const double off_deg : {0.0, 0.3, 1.0, 3.0}) {
      const Vec<Body> aside = normalized(cross(sun, eye));
      const Vec<Body> normal = normalized(sun + eye) + std::tan(off_deg * kRadPerDeg) * aside;
      SceneSpec scene = scene_of(joined(rectangle({0, 0, 0}, {0, 2, 0}, {0, 0, 2}, "plate"),
                                        square({0.5, 0.3, 0.2}, normal, 0.02, "mirror"), "m/"),
                                 {grey_paint(0.9), gloss(slope)});
      scene.part = {{"plate", {"plate"}, 0, true, false}, {"mirror", {"m/mirror"}, 1, true, false}};
      ViewRequest r = view_of(5, 1000, {290, 290});
      put_sun(r.condition[0], sun);
      RETURN_IF_ERROR(judge(scene, r, effort == Effort::kFull ? 16384 : 2048,
                            absl::StrCat("slope ", slope, ", ", off_deg, " deg off"), worst));
    }
  return worst.finding();
}

// One mirror throws the sun onto another, and that to the sensor.
absl::StatusOr<Finding> mirror_pair(Effort effort) {
  Worst worst(student_t_bound(31, 18));
  const Vec<Body> sun = sun_at(20, 45), eye = body_from_aspect(0, 5);
  const Vec<Body> first{0.6, 0.5, -1.2}, second{0.6, -0.4, 0.3},
      between = normalized(second - first);
  for (const double slope : {0.02, 0.038, 0.042})
    for (const double half_m : {0.05, 0.2}) {
      Mesh mesh = joined(rectangle({0, 0, 0}, {0, 2, 0}, {0, 0, 2}, "plate"),
                         square(first, sun + between, half_m, "first"), "m/");
      mesh = joined(mesh, square(second, eye - between, half_m, "second"), "n/");
      SceneSpec scene = scene_of(mesh, {grey_paint(0.9), gloss(slope)});
      scene.part = {{"plate", {"plate"}, 0, true, false},
                    {"first", {"*first"}, 1, true, false},
                    {"second", {"*second"}, 1, true, false}};
      ViewRequest r = view_of(5, 1000, {290, 290, 290});
      put_sun(r.condition[0], sun);
      RETURN_IF_ERROR(judge(scene, r, effort == Effort::kFull ? 65536 : 4096,
                            absl::StrCat("slope ", slope, ", mirrors of ", 2 * half_m, " m"),
                            worst));
    }
  return worst.finding();
}

// Small bright sources are aimed at, so that 1 % accuracy is reached and is true.
absl::StatusOr<Finding> small_bright_sources(Effort effort) {
  Worst worst(student_t_bound(31, 30));
  for (const auto& [rare, plain] : small_bright_source_scenes()) {
    RETURN_IF_ERROR(
        judge(rare.scene, rare.request, effort == Effort::kFull ? 65536 : 8192, rare.name, worst));
  }
  return worst.finding();
}

// The rays of each over those of the plate alone.
absl::StatusOr<Finding> small_bright_sources_cost(Effort /*effort*/) {
  Worst worst(20);
  for (const auto& [rare, plain] : small_bright_source_scenes()) {
    double rays[2] = {};
    int k = 0;
    for (const RareLightScene* one : {&rare, &plain}) {
      ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one->scene));
      ASSIGN_OR_RETURN(const auto view, simulator->simulate(one->request));
      rays[k++] = static_cast<double>(view.rays);
      worst.require(view.row[0].stop_reason == StopReason::kTargetReached,
                    [&] { return absl::StrCat(one->name, ": 1 % is not reached"); });
    }
    worst.see(rays[0] / rays[1],
              [&] { return absl::StrCat(rare.name, ": ", rays[0], " rays, without ", rays[1]); });
  }
  return worst.finding();
}

// A wall above the waterline: what stands behind it changes from sea to sky as the sensor rises.
absl::StatusOr<Finding> raised_sensor(Effort effort) {
  Worst worst(student_t_bound(31, 30));
  constexpr double kAlongM = 5000;
  for (const double sensor_m : {2.0, 5.0, 10.0, 10.001, 30.0})
    for (const double height_m : {2.0, 7.0}) {
      SceneSpec scene =
          scene_of(rectangle({0, 0, -height_m}, {0, 1, 0}, {0, 0, 1}, "wall"), {grey_paint(0.7)});
      scene.part = {{"wall", {}, 0, true, false}};
      const double up_m = sensor_m - kAlongM * kAlongM / (2 * kEarthRadiusM);
      ViewRequest r =
          view_of(std::atan2(up_m, kAlongM) / kRadPerDeg, std::hypot(kAlongM, up_m), {300});
      r.condition[0].surroundings = {SurroundingsKind::kSea, 220, 0, 290, 0.95, 0};
      RETURN_IF_ERROR(judge(scene, r, effort == Effort::kFull ? 4096 : 1024,
                            absl::StrCat("sensor ", sensor_m, " m, wall ", height_m, " m"), worst));
    }
  return worst.finding();
}

// Emissivity that falls to a third within less than a step of the band.
absl::StatusOr<Finding> notch(Effort effort) {
  Worst worst(student_t_bound(31, 12));
  for (const double step_um : {0.5, 0.25})
    for (const double width_um : {0.2, 0.02}) {
      const double low = 4.03, high = low + width_um;
      MaterialSpec paint{"paint", Lambert{{{2, 0.9},
                                           {low, 0.9},
                                           {low + 0.01 * width_um, 0.1},
                                           {high - 0.01 * width_um, 0.1},
                                           {high, 0.9},
                                           {15, 0.9}}}};
      SceneSpec scene = scene_of(rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, "wall"), {paint});
      scene.part = {{"wall", {}, 0, true, false}};
      scene.band = {{"MWIR", 3, 5, step_um, {}}};
      ViewRequest r = view_of(5, 1000, {310});
      r.accuracy.relative_error = 0.003;
      RETURN_IF_ERROR(judge(scene, r, effort == Effort::kFull ? 262144 : 32768,
                            absl::StrCat("step ", step_um, " um, notch ", width_um, " um"), worst));
    }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> honesty_cases() {
  const char* reason = "Student's t of all values";
  return {
      {"honesty", "grazing_gloss", "slopes 0.04 to 0.3 at 80 to 89 deg, the sun opposite [errors]",
       reason, grazing_gloss},
      {"honesty", "forward_glint",
       "gloss 0.5 deg from its plane, the sun nearly behind it [errors]", reason, forward_glint},
      {"honesty", "hot_behind_a_hole", "1200 K behind holes of 1/10 to 1/400 of a plate [errors]",
       reason, hot_behind_a_hole},
      {"honesty", "small_mirror", "1e-4 of a plate, 0 to 3 deg beside the sun [errors]", reason,
       small_mirror},
      {"honesty", "mirror_pair", "sunlight by way of two small mirrors [errors]", reason,
       mirror_pair},
      {"honesty", "small_bright_sources", "to 1 %: holes, small mirrors, pairs of mirrors [errors]",
       reason, small_bright_sources},
      {"honesty", "small_bright_sources_cost", "the same: rays over those of the plate alone",
       "what was asked for", small_bright_sources_cost},
      {"honesty", "raised_sensor", "sensors of 2 to 30 m, walls of 2 and 7 m, 5 km [errors]",
       reason, raised_sensor},
      {"honesty", "notch", "emissivity 0.1 within a step of the band [errors]", reason, notch},
  };
}

}  // namespace irsig
