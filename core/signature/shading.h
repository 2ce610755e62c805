#pragma once

#include <vector>

#include "core/signature/signature.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// The source radiances of one condition on the sweep's nodes, and how they meet the weights of a
// replicate.
class ConditionShading {
 public:
  ConditionShading(const ConditionSpec& condition, const Air& air, double range_m,
                   const SourceClasses& classes, int sun_index, const std::vector<double>& node_um);

  // Radiance of class c behind first part f at node i; for the sun: irradiance.      [W/(m2 sr um)]
  [[nodiscard]] const std::vector<double>& source(std::uint32_t first,
                                                  std::uint32_t source_class) const;

  // Everything that is stored of one band, for one replicate, in this order: in-band total; the
  // kCauses; apparent in-band; projected area; parts in-band; then for the total, each cause and
  // apparent the stored wavelengths.
  void evaluate(const PathWeights& weights, bool spectral, const BandGrid& grid,
                std::size_t node_offset, std::vector<double>& out) const;

  // The largest in-band radiance of any source, a sunlit white surface included: what a lost path
  // can have carried at most. [W/(m2 sr)]
  [[nodiscard]] double brightest_w_m2_sr(const BandGrid& grid, std::size_t node_offset) const;

  [[nodiscard]] const AirPath& air() const { return air_; }

 private:
  SourceClasses classes_;
  int sun_index_;  // which sun of the path tracer shines in this condition; -1: none
  std::size_t nodes_;
  std::vector<std::vector<double>> part_, sun_;  // blackbody radiance of each part; [0]: irradiance
  std::vector<double> sky_, lower_, none_;
  AirPath air_;
};

[[nodiscard]] std::size_t quantities(std::size_t parts, const BandGrid& grid);

}  // namespace irsig
