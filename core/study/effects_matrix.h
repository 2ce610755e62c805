#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/study/effects_check.h"

namespace irsig {

// Built-in scenes on which the automatic choice of effects is compared with all effects: every
// combination of what decides about effects, and cases made to deceive the choice. One condition
// and one band each, so that an effect is off whenever that row can do without it.
struct MatrixCell {
  std::string name;
  // Levels of the factorial's factors, in the order of kMatrixFactors; empty: a hard case, or one
  // with hot gas.
  std::vector<std::string> level;
  std::string why;  // a hard case: what makes it one
  SceneSpec scene;
  std::vector<Viewpoint> viewpoint;
  ConditionSpec condition;
  WeatherSpec weather;
  [[nodiscard]] bool has_gas() const { return condition.gas != nullptr; }
  double target_height_m = 4;
  std::uint32_t max_reflections = 16;
};

inline constexpr std::array<const char*, 7> kMatrixFactors = {
    "sun", "band", "surface", "shape", "temperature", "below", "range"};

// Returns night/day x MWIR/LWIR x matt/mirror-like x convex/cavity x hot/cold x sea/land x 0.5/5/50
// km, the last the fastest: 192 cells of four viewpoints.
[[nodiscard]] absl::StatusOr<std::vector<MatrixCell>> factorial_cells();

// Returns hard cells: a tiny hot spot, seen directly or in a mirror only; a mirror that throws the
// sun into one of the viewpoints; a cavity of more than 20 reflections; thermal crossover; the sun
// at 1 deg; a target before the sky; and others.
[[nodiscard]] absl::StatusOr<std::vector<MatrixCell>> hard_cells();

// Gas of 700 and 1200 K above a matt and a mirror-like deck, MWIR and LWIR, through 0.1, 5 and 50
// km of air: 24 cells of three viewpoints.
[[nodiscard]] absl::StatusOr<std::vector<MatrixCell>> plume_cells();

// Returns all cells above. small: the hard cells, six of the factorial's and three with hot gas,
// two viewpoints each.
[[nodiscard]] absl::StatusOr<std::vector<MatrixCell>> matrix_cells(bool small);

struct MatrixOptions {
  double relative_error = 0.01;
  double reference_paths = 100;  // EffectsCheckOptions
  std::uint32_t timed = 1;
  // Instead of the program's choice: all effects but this one, so that its bound can be seen.
  std::optional<Effect> without;
};
struct CheckedCell {
  std::vector<CheckedView> view;  // [viewpoint]; the first with the times of a first view
  EffectsSummary summary;
};
[[nodiscard]] absl::StatusOr<CheckedCell> check_cell(const MatrixCell& cell,
                                                     const MatrixOptions& options,
                                                     const CpuClock& cpu_s);

}  // namespace irsig
