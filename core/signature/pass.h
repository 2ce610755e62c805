#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/signature/shading.h"
#include "core/signature/signature.h"
#include "core/signature/unseen.h"
#include "core/signature/view_environments.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// Tracing one view for a set of conditions and bands (the rows): which suns shine, how the
// conditions shade, and the statistics and error bounds of what is stored. The pilots are passes,
// and so is the stored run.
class Pass {
 public:
  // plan: its effects; its number of samples is not looked at. environments: of the request's
  // conditions as far as they are among `conditions`; node_um, band_offset: the simulator's nodes
  // and where each band's begin. All must outlive it.
  Pass(const Simulator& simulator, const ViewRequest& request, const ViewPlan& plan,
       const AimedView& view, const ViewEnvironments& environments,
       std::span<const std::uint32_t> conditions, std::span<const std::uint32_t> bands,
       const std::vector<double>& node_um, const std::vector<std::size_t>& band_offset,
       std::uint64_t seed);

  enum class Replicated : std::uint8_t { kSource, kApparent, kContrast };

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
  [[nodiscard]] const ImagePlan& image_plan() const { return image_plan_; }

  // The bias bounds of a row. Reflections that the plan leaves out are `omitted`, those that the
  // request does not allow `truncation`.                                                    [W/sr]
  struct Bounds {
    double truncation, quadrature, basis, unseen, sky;
    RowBounds::Bound omitted;
    [[nodiscard]] double source() const { return common() + omitted.source; }
    [[nodiscard]] double apparent() const { return common() + omitted.apparent; }
    [[nodiscard]] double contrast() const { return common() + omitted.contrast; }

   private:
    [[nodiscard]] double common() const { return truncation + quadrature + basis + unseen + sky; }
  };
  [[nodiscard]] Bounds bounds(std::size_t row) const;

  // The error that the request wants of a row: relative to its value, or the absolute floor if that
  // is more. [W/sr]
  [[nodiscard]] double goal_w_sr(std::size_t row) const;
  [[nodiscard]] double absolute_floor_w_sr(std::size_t row) const;
  // The standard error that a row may keep for its numerical error to reach its goal. What is
  // unseen takes nothing of it: more samples meet it or rule it out.
  [[nodiscard]] double stderr_wanted(std::size_t row) const;

  // Throughput that goes on after each number of reflections, and an upper limit of it that
  // sampling will hardly exceed: 4 standard errors, and as much as none of the samples may have
  // met. [m2]
  [[nodiscard]] Estimate beyond_m2(std::uint32_t reflections) const;
  [[nodiscard]] double beyond_limit_m2(std::uint32_t reflections) const;
  // Of any source that a lost path may have met. [W/(m2 sr)]
  [[nodiscard]] double brightest_w_m2_sr(std::size_t row) const { return brightest_[row]; }
  // Of one band, all conditions alike. Not of pilots.
  [[nodiscard]] const EnergyLedger& energy(std::size_t row) const {
    return energy_[row % bands_.size()];
  }
  // [replicate]
  [[nodiscard]] const std::vector<double>& replicates(std::size_t row, Replicated what) const {
    return replicate_[row][static_cast<std::size_t>(what)];
  }

 private:
  [[nodiscard]] double unseen_w_sr(const ConditionShading& shading, const BandGrid& grid,
                                   std::size_t offset) const;
  [[nodiscard]] double find_brightest_w_m2_sr(std::size_t row) const;
  [[nodiscard]] double unseen_rim_w_sr(std::size_t row) const;
  [[nodiscard]] ImagePlan plan_images(const PathTracer& tracer) const;

  void find_energy(std::span<const PathWeights> weights, std::span<const RowWeights> summed,
                   const SpectralBasis* basis);

  const Simulator& simulator_;
  const ViewRequest& request_;
  const ViewPlan& plan_;
  std::vector<std::uint32_t> conditions_, bands_;
  const std::vector<std::size_t>& band_offset_;
  std::uint64_t seed_;
  const ViewEnvironments& environments_;
  SourceClasses classes_;
  std::vector<SunDirection> suns_;
  std::vector<UnseenSun> unseen_sun_;
  std::vector<double> brightest_;          // [row]
  std::vector<ConditionShading> shading_;  // [condition]
  std::vector<SourceTable> in_band_;       // [row]
  std::vector<ReplicateStatistics> statistics_;
  ReplicateStatistics last_;        // [row]: paths of the last order alone
  std::vector<double> basis_w_sr_;  // [row]
  std::array<double, 3> beyond_m2_{};
  ReplicateStatistics beyond_;                                 // [order]
  std::vector<EnergyLedger> energy_;                           // [band]
  std::vector<std::array<std::vector<double>, 3>> replicate_;  // [row][Replicated]
  PathCounts counts_;
  std::uint64_t samples_ = 0;
  ImagePlan image_plan_;
  std::vector<double> image_;
  const AimedView& view_;
};

}  // namespace irsig
