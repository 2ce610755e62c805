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
  // Levels of the factorial's factors, in the order of kMatrixFactors; empty: a hard case.
  std::vector<std::string> level;
  std::string why;  // a hard case: what makes it one
  SceneSpec scene;
  std::vector<Viewpoint> viewpoint;
  ConditionSpec condition;
  WeatherSpec weather;
  double target_height_m = 4;
  std::uint32_t max_reflections = 16;
};

inline constexpr std::array<const char*, 7> kMatrixFactors = {
    "sun", "band", "surface", "shape", "temperature", "below", "range"};

// night/day x MWIR/LWIR x matt/mirror-like x convex/cavity x hot/cold x sea/land x 0.5/5/50 km, the
// last the fastest: 192 cells of four viewpoints.
[[nodiscard]] absl::StatusOr<std::vector<MatrixCell>> factorial_cells();

// A tiny hot spot seen and seen in a mirror only, a mirror that throws the sun into one of the
// viewpoints, a cavity of more than 20 reflections, thermal crossover, the sun at 1 deg, a target
// before the sky, ...
[[nodiscard]] absl::StatusOr<std::vector<MatrixCell>> hard_cells();

// All of the above; small: the hard cells and six of the factorial's, two viewpoints each.
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
