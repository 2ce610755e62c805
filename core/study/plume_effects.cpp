// The cells of the matrix of effects with hot gas.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/gas/gas_spectrum.h"
#include "core/plume/generate_plume.h"
#include "core/plume/plume_field.h"
#include "core/study/effects_matrix.h"
#include "core/study/matrix_bodies.h"
#include "core/study/matrix_worlds.h"

namespace irsig {
namespace {

// A sphere of exhaust of 1.5 m above a deck.
absl::StatusOr<std::shared_ptr<const PlumeField>> gas_above_deck(double kelvin) {
  UniformPlume spec;
  spec.kind = "sphere";
  spec.radius_m = 1.5;
  spec.temperature_k = kelvin;
  spec.co2 = 0.07;
  spec.h2o = 0.06;
  spec.soot = 1e-8;
  spec.voxel_m = 0.25;
  ASSIGN_OR_RETURN(auto made, generate_uniform_plume(spec));
  made.grids.position_m = {0, 0, -10};
  return plume_of(made.volume, made.grids);
}

}  // namespace

absl::StatusOr<std::vector<MatrixCell>> plume_cells() {
  std::vector<MatrixCell> out;
  for (const double kelvin : {700.0, 1200.0}) {
    ASSIGN_OR_RETURN(const auto gas, gas_above_deck(kelvin));
    for (const bool long_wave : {false, true})
      for (const bool mirror : {false, true})
        for (const double range_m : {100.0, 5e3, 50e3}) {
          MatrixCell& cell = out.emplace_back();
          cell.name = absl::StrCat("plume ", kelvin, " K ", long_wave ? "lwir" : "mwir",
                                   mirror ? " mirror " : " matt ", range_m / 1000, " km");
          cell.why = "hot gas above a deck that reflects it";
          ASSIGN_OR_RETURN(auto material, mirror ? bare_aluminium() : matt_paint(0.9));
          cell.scene.mesh = shifted(block({5, 2, 3}), {0, 0, -4});
          cell.scene.material = {std::move(material)};
          cell.scene.part = {{"target", {"*"}, 0, false, false}};
          cell.scene.band = {long_wave ? long_wave_band() : mid_wave_band()};
          cell.weather = open_sea();
          cell.condition = condition_over(cell.weather, {300.0});
          add_sun(cell.condition, 130, 35);
          cell.condition.gas = gas;
          cell.viewpoint = grid_of({{200, 40}, {100, 5}, {75, 25}}, range_m);
          cell.max_reflections = 3;
        }
  }
  return out;
}

}  // namespace irsig
