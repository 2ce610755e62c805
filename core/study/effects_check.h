#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/simulator.h"
#include "core/study/work_precision.h"

namespace irsig {

// Some effects against all effects: what leaving the others out changed, whether the bounds that
// are stored with it cover that, and what it saved. "Chosen": by the program, or by whoever asks.

enum class Compared : std::uint8_t { kSource, kApparent, kContrast };
inline constexpr std::size_t kCompared = 3;
inline constexpr std::array<std::string_view, kCompared> kComparedName = {"source", "apparent",
                                                                          "contrast"};

// Sums of single-precision weights in another order: both runs follow the same paths, but where one
// of them leaves out directions or reflections, batches and node sums are cut otherwise. Relative
// to the apparent and source intensity, whichever is larger: contrast is a difference of numbers of
// that size. A weight of 24 bits is right to 6e-8; what the widest tests of this arithmetic allow
// is 3e-7 (tests/physics/sky_nodes_test.cpp).
inline constexpr double kRoundingRelative = 3e-7;

// One quantity of one row, both ways on the same paths. [W/sr]
struct ComparedValue {
  double chosen_w_sr = 0, all_w_sr = 0;
  double difference_w_sr = 0;     // chosen - all: mean over the replicates
  double paired_stderr_w_sr = 0;  // of that mean, from the replicates' differences
  double omitted_bound_w_sr = 0;  // stored with the chosen row
  double rounding_w_sr = 0;
  double stderr_w_sr = 0, numerical_error_w_sr = 0;  // stored with the chosen row
  // A long run with all effects and another seed; its standard error is 0 if there was none.
  double reference_w_sr = 0, reference_stderr_w_sr = 0;

  [[nodiscard]] double allowed_w_sr() const {
    return omitted_bound_w_sr + 4 * paired_stderr_w_sr + rounding_w_sr;
  }
  // Returns |difference| / allowance; above 1 the difference is out of bound.
  [[nodiscard]] double of_allowed() const;
  // Returns |chosen - reference| / sqrt(numerical error^2 + the reference's standard error^2 +
  // rounding^2).
  [[nodiscard]] double of_numerical_error() const;
};

struct CheckedRow {
  std::uint32_t condition = 0, band = 0;
  std::array<ComparedValue, kCompared> value;
  std::array<EffectState, kEffectCount> effect{};  // of the chosen run, by their numbers
  std::uint32_t reflections = 0;                   // the most that its paths were given

  [[nodiscard]] bool is_off(Effect effect) const;
  // Returns true if some reflected light, or all further reflections, are left out.
  [[nodiscard]] bool drops_reflections() const;
};

struct CheckedView {
  Viewpoint viewpoint{};
  std::vector<CheckedRow> row;  // as requested
  // Plan and measurement of each run for the same asked accuracy, with its own number of samples:
  // CPU time once what views share is known, and of the first view of all with that. [s]
  double chosen_s = 0, all_s = 0;
  double chosen_first_s = 0, all_first_s = 0;         // 0: not measured
  std::uint64_t chosen_samples = 0, all_samples = 0;  // of a replicate
  bool referenced = false;
};

struct EffectsCheckOptions {
  // The environment of the run with all effects: the same as the request's, made afresh, so that
  // neither run finds what the other has computed. Null: the request's own.
  std::shared_ptr<const Environment> environment_for_all;
  bool first_view = false;     // nothing is cached yet: measure the first times, then the others
  std::uint32_t timed = 1;     // runs, of which the fastest counts
  double reference_paths = 0;  // of the reference over those of the chosen run; 0: no reference
  std::uint64_t most_reference_samples = 1u << 19;  // of a replicate
};

// Computes one view with the request's choice of effects and with all. The errors are those of the
// simulator.
[[nodiscard]] absl::StatusOr<CheckedView> check_effects(const Simulator& simulator,
                                                        ViewRequest request,
                                                        const EffectsCheckOptions& options,
                                                        const CpuClock& cpu_s);

struct EffectsSummary {
  std::size_t views = 0, rows = 0, values = 0;  // values: rows x quantities
  std::size_t out_of_bound = 0;                 // values
  double largest_of_allowed = 0;
  std::array<std::size_t, kEffectCount> off{};             // rows that each effect was left out in
  std::size_t referenced = 0, beyond_2 = 0, beyond_5 = 0;  // values, numerical errors
  double largest_of_numerical_error = 0;
  double chosen_s = 0, all_s = 0, chosen_first_s = 0, all_first_s = 0;  // sums
  bool drops_reflections = false;                                       // in every row

  [[nodiscard]] double time_ratio() const { return all_s > 0 ? chosen_s / all_s : 1; }
};
[[nodiscard]] EffectsSummary summary_of(std::span<const CheckedView> views);

}  // namespace irsig
