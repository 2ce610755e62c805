#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/signature/shading.h"
#include "core/signature/signature.h"
#include "core/signature/unseen.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// What the conditions of a request do to one view, and the directions to which it refers.
struct ViewEnvironments {
  DirectionNodes directions, behind;
  std::vector<ViewEnvironment> condition;  // of the request; empty where it was not asked for
};
// INVALID_ARGUMENT as Environment::view() has it.
[[nodiscard]] absl::StatusOr<ViewEnvironments> view_environments(
    const ViewRequest& request, const Target& target, double range_m,
    std::span<const std::uint32_t> conditions, const std::vector<double>& node_um);

[[nodiscard]] bool over_sea(const ViewRequest& request);
// Whether a condition's sun shines: some of its disk is above the horizon.
[[nodiscard]] bool sun_shines(const ConditionSpec& condition);

// Tracing one view for a set of conditions and bands (the rows): which suns shine, how the
// conditions shade, and the statistics and error bounds of what is stored. The pilots are passes,
// and so is the stored run.
class Pass {
 public:
  // environments: of the request's conditions as far as they are among `conditions`; node_um,
  // band_offset: the simulator's nodes and where each band's begin.
  Pass(const Simulator& simulator, const ViewRequest& request, const AimedView& view,
       const ViewEnvironments& environments, std::span<const std::uint32_t> conditions,
       std::span<const std::uint32_t> bands, const std::vector<double>& node_um,
       const std::vector<std::size_t>& band_offset, std::uint64_t seed);

  // Traces all replicates afresh. A pilot knows in-band numbers only.
  enum class Kind { kPilot, kStored, kStoredWithPictures };
  void run(std::uint64_t samples, std::uint64_t stage, Kind kind);

  [[nodiscard]] std::size_t rows() const { return conditions_.size() * bands_.size(); }
  [[nodiscard]] const std::vector<std::uint32_t>& conditions() const { return conditions_; }
  [[nodiscard]] const std::vector<std::uint32_t>& bands() const { return bands_; }
  [[nodiscard]] const PathCounts& counts() const { return counts_; }
  [[nodiscard]] const ReplicateStatistics& statistics(std::size_t row) const {
    return statistics_[row];
  }
  [[nodiscard]] const ConditionShading& shading(std::size_t row) const {
    return shading_[row / bands_.size()];
  }
  [[nodiscard]] const std::vector<double>& image() const { return image_; }
  [[nodiscard]] const ViewFrame& frame() const { return view_.frame; }
  [[nodiscard]] const ImagePlan& plan() const { return plan_; }

  // The bias bounds of a row. [W/sr]
  struct Bounds {
    double truncation, quadrature, basis, unseen, sky;
    [[nodiscard]] double sum() const { return truncation + quadrature + basis + unseen + sky; }
  };
  [[nodiscard]] Bounds bounds(std::size_t row) const;

  // The standard error that a row may keep for its numerical error to be relative_error x its
  // value: what the bias bounds leave. Where they take more than 0.8 of that, samples cannot mend
  // it: the standard error is then brought to 0.6 of the goal, and the row will say that the target
  // was missed.
  [[nodiscard]] double stderr_wanted(std::size_t row, double relative_error) const;

 private:
  [[nodiscard]] double unseen_w_sr(const ConditionShading& shading, const BandGrid& grid,
                                   std::size_t offset) const;
  [[nodiscard]] ImagePlan image_plan(const PathTracer& tracer) const;

  const Simulator& simulator_;
  const ViewRequest& request_;
  std::vector<std::uint32_t> conditions_, bands_;
  const std::vector<std::size_t>& band_offset_;
  std::uint64_t seed_;
  const ViewEnvironments& environments_;
  SourceClasses classes_;
  std::vector<SunDirection> suns_;
  std::vector<UnseenSun> unseen_sun_;
  std::vector<ConditionShading> shading_;  // [condition]
  std::vector<SourceTable> in_band_;       // [row]
  std::vector<ReplicateStatistics> statistics_;
  ReplicateStatistics last_;        // [row]: paths of the last order alone
  std::vector<double> basis_w_sr_;  // [row]
  std::array<double, 3> beyond_m2_{};
  PathCounts counts_;
  std::uint64_t samples_ = 0;
  ImagePlan plan_;
  std::vector<double> image_;
  const AimedView& view_;
};

}  // namespace irsig
