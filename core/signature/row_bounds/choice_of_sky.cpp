#include <cmath>

#include "core/signature/row_bounds/row_bounds.h"
#include "core/signature/view/shading.h"

namespace irsig {

ThreeBounds choice_of_sky(const BoundInput& in) {
  const ConditionSources* sky = in.row.one_sky;
  if (sky == nullptr) return {};
  const SpectralBasis* basis = in.setup.scene.path_basis();
  const BandOnAxis& band = in.row.on_axis;
  std::vector<RowTally> tally;
  tally_row(*sky, in.setup.parts(), in.lit, basis, band,
            source_table(*sky, basis, band.first_node, band.grid.band_weight), false, tally);
  ThreeBounds mean;
  for (const RowTally& of_replicate : tally) {
    mean.source += of_replicate.total;
    mean.apparent += of_replicate.apparent;
    mean.contrast += of_replicate.contrast;
  }
  const auto replicates = static_cast<double>(tally.size());
  const double sigma = in.row.light->environment().one_sky_sigma;
  const RowEstimate& under_both = in.row.estimate;
  const auto spread = [&](double sum, const Estimate& own) {
    return sigma * std::abs(sum / replicates - own.value);
  };
  return {spread(mean.source, under_both.total), spread(mean.apparent, under_both.apparent),
          spread(mean.contrast, under_both.contrast)};
}

}  // namespace irsig
