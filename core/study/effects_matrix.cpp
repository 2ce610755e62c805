#include "core/study/effects_matrix.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_join.h"
#include "core/base/status_macros.h"
#include "core/study/matrix_bodies.h"
#include "core/study/matrix_worlds.h"

namespace irsig {
namespace {

struct Levels {
  bool day, long_wave, mirror, cavity, hot, sea;
  double range_m;
};

absl::StatusOr<MatrixCell> cell_of(const Levels& f) {
  MatrixCell cell;
  cell.level = {f.day ? "day" : "night",
                f.long_wave ? "lwir" : "mwir",
                f.mirror ? "mirror" : "matt",
                f.cavity ? "cavity" : "convex",
                f.hot ? "hot" : "cold",
                f.sea ? "sea" : "land",
                f.range_m < 1000   ? "0.5 km"
                : f.range_m < 10e3 ? "5 km"
                                   : "50 km"};
  cell.name = absl::StrJoin(cell.level, " ");
  const double height_m = 4;
  const Mesh body = f.cavity ? bay({8, 3, 3}, {6, 2, 2}, {6, 0, 2}) : drum(3, 16);
  ASSIGN_OR_RETURN(auto material, f.mirror ? bare_aluminium() : matt_paint(0.9));
  cell.scene.mesh = shifted(body, {0, 0, -height_m});
  cell.scene.material = {std::move(material)};
  cell.scene.part = {{"target", {"*"}, 0, false, false}};
  cell.scene.band = {f.long_wave ? long_wave_band() : mid_wave_band()};
  cell.weather = f.sea ? open_sea() : bare_land();
  cell.condition = condition_over(cell.weather, {f.hot ? 900.0 : 300.0});
  // Highlights of the drum, and the bay's back, face two of the viewpoints.
  if (f.day) add_sun(cell.condition, 130, 35);
  cell.viewpoint = grid_of({{100, 5}, {75, 25}, {200, 10}, {320, 50}}, f.range_m);
  cell.target_height_m = height_m;
  return cell;
}

}  // namespace

absl::StatusOr<std::vector<MatrixCell>> factorial_cells() {
  std::vector<MatrixCell> out;
  constexpr std::array<double, 3> kRangesM = {500, 5000, 50e3};
  for (const bool day : {false, true})
    for (const bool long_wave : {false, true})
      for (const bool mirror : {false, true})
        for (const bool cavity : {false, true})
          for (const bool hot : {true, false})
            for (const bool sea : {true, false})
              for (const double range_m : kRangesM) {
                ASSIGN_OR_RETURN(auto cell,
                                 cell_of({day, long_wave, mirror, cavity, hot, sea, range_m}));
                out.push_back(std::move(cell));
              }
  return out;
}

absl::StatusOr<std::vector<MatrixCell>> matrix_cells(bool small) {
  ASSIGN_OR_RETURN(auto factorial, factorial_cells());
  ASSIGN_OR_RETURN(auto hard, hard_cells());
  std::vector<MatrixCell> out;
  // Six cells in which every level of every factor occurs, most of them equally often.
  constexpr std::size_t kStride = 38;
  for (std::size_t i = 0; i < factorial.size(); i += small ? kStride : 1)
    out.push_back(std::move(factorial[i]));
  for (MatrixCell& cell : hard) out.push_back(std::move(cell));
  ASSIGN_OR_RETURN(auto gas, plume_cells());
  for (std::size_t i = 0; i < gas.size(); i += small ? 10 : 1) out.push_back(std::move(gas[i]));
  if (small)
    for (MatrixCell& cell : out)
      cell.viewpoint.resize(std::min<std::size_t>(cell.viewpoint.size(), 2));
  return out;
}

absl::StatusOr<CheckedCell> check_cell(const MatrixCell& cell, const MatrixOptions& options,
                                       const CpuClock& cpu_s) {
  SceneSpec scene = cell.scene;
  const Band& band = scene.band.front();
  scene.spectral_breaks_um =
      air_band_edges_um(band.lambda_min_um - band.step_um, band.lambda_max_um + band.step_um);
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  // Each run has one of its own: neither profits from what the other has made.
  const auto environment = [&]() -> absl::StatusOr<std::shared_ptr<const Environment>> {
    const ConditionSpec& c = cell.condition;
    auto made = Environment::make({cell.weather}, {{0, c.sun, c.sun_direction, 1}},
                                  cell.target_height_m, simulator->band_grids().front().node_um);
    if (!made.ok()) return made.status();
    return std::shared_ptr<const Environment>(*std::move(made));
  };
  ASSIGN_OR_RETURN(const auto for_chosen, environment());
  ASSIGN_OR_RETURN(const auto for_all, environment());
  ViewRequest request;
  request.condition = {cell.condition};
  if (cell.condition.sun) {
    const Environment::SunSeen& seen = for_chosen->sun_seen(0);
    request.condition[0].sun_direction = seen.direction;
    request.condition[0].sun_cos_zenith = -seen.direction.z;
    request.condition[0].sun_horizon_z = seen.horizon_z;
  }
  request.selected_condition = request.selected_band = {0};
  request.environment = for_chosen;
  request.max_reflections = cell.max_reflections;
  request.accuracy.relative_error = options.relative_error;
  request.accuracy.absolute_error_k = 0.05;  // as a sweep that does not say otherwise
  request.effects.mode = EffectChoice::Mode::kAuto;
  if (options.without && is_of_plume(*options.without)) {
    request.effects.without_plume = {*options.without};
  } else if (options.without) {
    request.effects.mode = EffectChoice::Mode::kOnly;
    for (const EffectInfo& info : effect_table())
      if (info.switchable && info.effect != *options.without)
        request.effects.only.push_back(info.effect);
  }
  CheckedCell out;
  for (const Viewpoint& viewpoint : cell.viewpoint) {
    request.viewpoint = viewpoint;
    ASSIGN_OR_RETURN(
        auto view,
        check_effects(*simulator, request,
                      {for_all, out.view.empty(), options.timed, options.reference_paths}, cpu_s));
    out.view.push_back(std::move(view));
  }
  out.summary = summary_of(out.view);
  return out;
}

}  // namespace irsig
