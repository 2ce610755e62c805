#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/accuracy/measured.h"
#include "core/signature/view/result.h"
#include "core/signature/view/trace_view.h"
#include "core/signature/view/view_setup.h"

namespace irsig {

// Totals of the last run of a view, for all rows together.
struct RunTotals {
  std::uint64_t samples = 0;  // of each replicate
  PathCounts counts;
  std::optional<UnknownSeen> unknown_seen;  // an emitter of unknown temperature that paths met
  // Throughput that goes on after N - 2 s, N - s and N reflections (PathWeights::beyond_m2).
  std::array<double, 3> beyond_m2{};
  ReplicateStatistics beyond;                  // [number of reflections]
  double front_area_m2 = 0, back_area_m2 = 0;  // of the silhouette, means over replicates
  double hidden_area_m2 = 0;                   // of the target, by land or the Earth, likewise
  std::vector<EnergyLedger> energy;            // [band]; empty in pilots
};

// MeasuredView is a view with its rows, as the last run measured them. Pilots and the stored run
// are runs of the same view.
struct MeasuredView {
  MeasuredView(const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
               std::shared_ptr<const PreparedView> view, RowKeys keys, std::uint64_t seed)
      : setup(scene, request, plan, std::move(view), std::move(keys), seed),
        row(rows_of(setup, request)) {}

  ViewSetup setup;
  std::vector<Row> row;  // conditions x bands
  RunTotals totals;

  // Replaces parts of the plan that were decided after the run.
  void leave_out(std::vector<RowBounds::Bound> omitted) { setup.plan.omitted = std::move(omitted); }
  void cut_reflections(std::uint32_t most) { setup.plan.effects.max_reflections = most; }
};

// A pilot has in-band numbers only.
enum class RunKind : std::uint8_t { kPilot, kStored };

// Traces all replicates of a view afresh.
//   stage  of the view's random numbers
//   kept   gets the weights of the paths, unless it is null
void run_view(MeasuredView& view, std::uint64_t samples, std::uint64_t stage, RunKind kind,
              std::vector<PathWeights>* kept = nullptr);
// Runs a pilot of one stratum alone: of what is seen in it.
void run_stratum(MeasuredView& view, std::uint32_t stratum, std::uint64_t samples,
                 std::uint64_t stage);

// A row's three intensities with their errors and bounds; pilots are without those of the air and
// of the background. Reflections that the plan leaves out are `omitted`, those that the request
// does not allow `truncation`. [W/sr]
struct MeasuredIntensities {
  Measured source, apparent, contrast;
};
[[nodiscard]] MeasuredIntensities measured(const MeasuredView& view, const Row& row);

// Returns the fraction of the silhouette that primary rays met from behind on one-sided facets,
// which emit nothing there.
[[nodiscard]] double backface_fraction(const MeasuredView& view);

// Returns the error that the request allows a row: relative to the row's value, the absolute floor,
// and the larger of both. For a row of value 0, goal_w_sr() is at least 1e-9 pi radius^2 of the
// target x the row's brightest thermal radiance. [W/sr]
[[nodiscard]] double relative_goal_w_sr(const MeasuredView& view, const Row& row);
[[nodiscard]] double absolute_floor_w_sr(const MeasuredView& view, const Row& row);
[[nodiscard]] double goal_w_sr(const MeasuredView& view, const Row& row);
// Returns the standard error with which a row reaches its goal, next to the bounds that more
// samples do not lower. [W/sr]
[[nodiscard]] double stderr_wanted_w_sr(const MeasuredView& view, const Row& row);

// Returns an upper limit on the throughput that goes on after so many reflections, which sampling
// hardly exceeds: 4 standard errors, and the throughput that none of the samples may have met. [m2]
[[nodiscard]] double beyond_limit_m2(const MeasuredView& view, std::uint32_t reflections);

// Brightness of facets in no hot part, for choosing facets to aim at: the largest radiance that a
// facet may show per wanted error, in the row where that is largest; and its visible area.
struct FacetBrightness {
  std::uint32_t facet;
  double seen_m2, per_m2;
};
[[nodiscard]] std::vector<FacetBrightness> facet_brightness(const MeasuredView& view);

}  // namespace irsig
