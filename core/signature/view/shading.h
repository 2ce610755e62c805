#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/signature/view/row_tally.h"
#include "core/sources/condition_sources.h"
#include "core/sources/source_weights.h"
#include "core/transport/path_tracer.h"
#include "core/transport/spectral_basis.h"

namespace irsig {

// Multiplies the weights of paths with the light of the sources: integrals over wavelength.

// An integral of all sources over wavelength, as weights that paths carry want it: a row of columns
// first_column .. first_column + columns - 1 of those that paths carry for each source.
struct SourceTable {
  std::size_t first_column = 0, columns = 1;
  std::vector<double> source, apparent;
  // Interpolation errors of sources around the target: the largest error found in one of the
  // directions for which a source stands. [source.around()][column]
  std::vector<double> interpolation;

  [[nodiscard]] const double* row(SourceId id) const {
    return source.data() + index_of(id) * columns;
  }
};

// Returns the table for the given weights over nodes [first_node, first_node + weight.size()).
// `basis`: null if all materials are grey.
[[nodiscard]] SourceTable source_table(const ConditionSources& light, const SpectralBasis* basis,
                                       std::size_t first_node, std::span<const double> weight);

// Returns one row for all sources alike: radiance 1, weights that add up to 1.
[[nodiscard]] SourceTable unit_table(const SpectralBasis* basis, std::size_t first_node,
                                     std::span<const double> weight);

// Weights as the light of one condition meets them, and their sums over parts, for each replicate.
class LitWeights {
 public:
  // weights: of paths; they outlive this.
  LitWeights(const ConditionSources& light, std::span<const PathWeights> weights,
             std::size_t parts);
  LitWeights(const LitWeights&) = delete;  // refers to its own
  LitWeights& operator=(const LitWeights&) = delete;

  [[nodiscard]] std::size_t replicates() const { return sum_.size(); }
  [[nodiscard]] const SourceWeights& weight(std::size_t replicate) const {
    return *weight_[replicate];
  }
  [[nodiscard]] const SummedWeights& sum(std::size_t replicate) const { return sum_[replicate]; }
  [[nodiscard]] std::span<const SummedWeights> sums() const { return sum_; }
  [[nodiscard]] double area_m2(std::size_t replicate) const { return area_m2_[replicate]; }
  [[nodiscard]] SummedWeights mean() const;

 private:
  std::vector<SourceWeights> own_;
  std::vector<const SourceWeights*> weight_;
  std::vector<SummedWeights> sum_;
  std::vector<double> area_m2_;
};
// Sums the light of one table of weights.
[[nodiscard]] SummedWeights summed_light(const ConditionSources& light,
                                         const SourceWeights& weights, std::size_t parts);

// Computes everything that is stored of one band, for each replicate.
//   parts    how many parts can be seen first
//   whole    source_table() over the band
//   spectra  false, for pilots: no spectra, and 0 for each part
//   tally    [replicate] set
void tally_row(const ConditionSources& light, std::size_t parts, const LitWeights& weights,
               const SpectralBasis* basis, const BandOnAxis& band, const SourceTable& whole,
               bool spectra, std::vector<RowTally>& tally);

// The weights themselves, as means over the nodes: of what the target absorbs, of sky, of what lies
// below the horizon. `unit`: of unit_table().
struct Shares {
  double absorbed, sky, lower;
};
[[nodiscard]] Shares shares(const SummedWeights& sums, const SourceLayout& layout,
                            const SourceTable& unit);

// Returns the in-band sum over the weights of one replicate, and of the light that is seen straight
// alone.
[[nodiscard]] double in_band_w_sr(const ConditionSources& light, const SummedWeights& sums,
                                  const SourceTable& in_band);
[[nodiscard]] double emitted_in_band_w_sr(const SourceLayout& layout, const SummedWeights& sums,
                                          const SourceTable& in_band);

// Returns the bounds on sources around the target, met with one replicate's weights or their mean.
[[nodiscard]] double interpolation_w_sr(const SourceTable& table, SourceRange nodes,
                                        const SourceLayout& layout, const SummedWeights& sums);

// Returns the in-band integral of a spectrum on the sweep's nodes times one source's weights.
[[nodiscard]] double nodes_w_sr(std::span<const double> spectrum, const SpectralBasis* basis,
                                const BandOnAxis& band, const double* weight);

// Returns the largest of each source's weights on any node of the sweep. [source]
[[nodiscard]] std::vector<double> largest_on_nodes(const SummedWeights& sums,
                                                   const SpectralBasis& basis);
// Returns the in-band sum if the weights of every source were the largest at all nodes. [W/sr]
[[nodiscard]] double largest_in_band_w_sr(const ConditionSources& light,
                                          const std::vector<double>& largest,
                                          const BandOnAxis& band);

}  // namespace irsig
