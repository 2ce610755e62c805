#pragma once

#include <vector>

#include "core/signature/signature.h"
#include "core/transport/path_tracer.h"
#include "core/transport/spectral_basis.h"

namespace irsig {

// The weights of one replicate on all nodes, summed over the parts seen first as far as they meet
// the same source: own emission of part f in row f, then the classes after `own`.
struct WeightSpectra {
  std::size_t nodes = 0;
  std::vector<double> value;  // [row][node]
};
[[nodiscard]] WeightSpectra weight_spectra(const PathWeights& weights, const SourceClasses& classes,
                                           const SpectralBasis& basis);

// The source radiances of one condition on the sweep's nodes, and how they meet the weights of a
// replicate.
class ConditionShading {
 public:
  ConditionShading(const ConditionSpec& condition, const Air& air, double range_m,
                   const SourceClasses& classes, int sun_index, const std::vector<double>& node_um);

  // Radiance of class c behind first part f at node i; for the sun: irradiance.      [W/(m2 sr um)]
  [[nodiscard]] const std::vector<double>& source(std::uint32_t first,
                                                  std::uint32_t source_class) const;

  // A band's in-band sources as the weights that paths carry want them: one row for the own
  // emission of each part, then one for each class after `own`; [row][carried node].
  [[nodiscard]] std::vector<double> fold(const SpectralBasis& basis, const BandGrid& grid,
                                         std::size_t node_offset) const;

  // Everything that is stored of one band, for one replicate, in this order: in-band total; the
  // kCauses; apparent in-band; projected area; parts in-band; then for the total, each cause and
  // apparent the stored wavelengths. spectra, folded: empty if all materials are grey.
  void evaluate(const PathWeights& weights, const WeightSpectra& spectra,
                const std::vector<double>& folded, const BandGrid& grid, std::size_t node_offset,
                std::vector<double>& out) const;

  // The in-band sum over the weights of one table: in a tracer's layout, `columns` nodes (1: grey).
  [[nodiscard]] double in_band_w_sr(const std::vector<double>& weight, std::size_t columns,
                                    const std::vector<double>& folded, const BandGrid& grid,
                                    std::size_t node_offset) const;

  // The in-band sum if every row of weights had its largest value at all nodes. [W/sr]
  [[nodiscard]] double largest_in_band_w_sr(const WeightSpectra& spectra, const BandGrid& grid,
                                            std::size_t node_offset) const;

  // In-band irradiance of the condition's sun; 0 if none shines. [W/m2]
  [[nodiscard]] double sun_w_m2(const BandGrid& grid, std::size_t node_offset) const;
  [[nodiscard]] int sun_index() const { return sun_index_; }
  // The largest in-band radiance of anything but the sun. [W/(m2 sr)]
  [[nodiscard]] double brightest_thermal_w_m2_sr(const BandGrid& grid,
                                                 std::size_t node_offset) const;
  // The largest in-band radiance of a part. [W/(m2 sr)]
  [[nodiscard]] double part_w_m2_sr(std::uint32_t part, const BandGrid& grid,
                                    std::size_t node_offset) const;

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
