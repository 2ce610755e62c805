#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/signature/signature.h"
#include "core/transport/path_tracer.h"
#include "core/transport/spectral_basis.h"

namespace irsig {

// The weights of one replicate, summed over the parts seen first as far as they meet the same
// source: own emission of part f in row f, then the classes after `own`. [row][column]
struct RowWeights {
  std::uint32_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> value;
};
// `weight`: one table in a tracer's layout.
[[nodiscard]] RowWeights row_weights(std::span<const double> weight, const SourceClasses& classes,
                                     std::size_t columns);
// On all nodes of the sweep. [row][node]
[[nodiscard]] std::vector<double> on_nodes(const RowWeights& weights, const SpectralBasis& basis);

// An integral of all sources over wavelength, as weights that paths carry want it: [row][column],
// of columns first_column .. first_column + columns - 1 of those that paths carry.
struct SourceTable {
  std::size_t first_column = 0, columns = 1;
  std::vector<double> source, apparent;
};

// What surroundings without an atmosphere do to a view: uniform sky and lower hemisphere,
// homogeneous air or none.
[[nodiscard]] ViewEnvironment plain_environment(const ConditionSpec& condition, const Air& air,
                                                double range_m, bool sun,
                                                const std::vector<double>& node_um);

// The sources of one condition on the sweep's nodes, and how they meet the weights of a replicate.
class ConditionShading {
 public:
  // environment: outlives this. effects, sun: those of the view and of this condition; what they
  // leave out is dark.
  ConditionShading(const ConditionSpec& condition, const ViewEnvironment& environment,
                   const SourceClasses& classes, int sun_index, const std::vector<double>& node_um,
                   const EffectSet& effects = {}, const EffectSet::Sun& sun = {});

  // Radiance of class c behind first part f at node i; for the sun: irradiance. At the target, and
  // what of it arrives at the sensor. A class behind the target is no source: it has the latter
  // only.                                                               [W/(m2 sr um)], [W/(m2 um)]
  [[nodiscard]] const std::vector<double>& source(std::uint32_t first,
                                                  std::uint32_t source_class) const;
  [[nodiscard]] const std::vector<double>& apparent(std::uint32_t first,
                                                    std::uint32_t source_class) const;

  // The integral with the given weights over nodes [first, first + weight.size()). `basis`: null if
  // all materials are grey.
  [[nodiscard]] SourceTable table(const SpectralBasis* basis, std::size_t first_node,
                                  std::span<const double> weight) const;

  // Everything that is stored of one band, for each replicate. In-band: total; the kCauses;
  // apparent; projected area; parts; contrast; background radiance. With `spectra`, on the stored
  // wavelengths: the total, each cause, apparent, contrast, background radiance.
  // values[replicate][quantity].
  void evaluate(std::span<const PathWeights> weights, std::span<const RowWeights> rows,
                const SpectralBasis* basis, const BandGrid& grid, std::size_t node_offset,
                bool spectra, std::vector<std::vector<double>>& values) const;

  // The weights themselves, as means over the nodes: of what the target absorbs, of sky, of what
  // lies below the horizon. `unit`: of unit_table().
  struct Shares {
    double absorbed, sky, lower;
  };
  [[nodiscard]] static Shares shares(const RowWeights& rows, const SourceClasses& classes,
                                     const SourceTable& unit);

  // The in-band sum over one table of weights in a tracer's layout.
  [[nodiscard]] double in_band_w_sr(const RowWeights& rows, const SourceTable& in_band) const;

  // The in-band sum if every row of weights (on nodes) had its largest value at all of them. [W/sr]
  [[nodiscard]] double largest_in_band_w_sr(const std::vector<double>& row_on_node,
                                            const BandGrid& grid, std::size_t node_offset) const;

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

  [[nodiscard]] const ViewEnvironment& environment() const { return *environment_; }

 private:
  [[nodiscard]] bool is_dark(std::uint32_t source_class) const;
  [[nodiscard]] std::uint32_t class_of_row(std::uint32_t row) const {
    return row < classes_.parts ? classes_.own() : row - classes_.parts + 1;
  }
  [[nodiscard]] std::uint32_t row_of_class(std::uint32_t c) const { return classes_.parts + c - 1; }

  struct Rows {
    std::uint32_t first, last;  // behind the last
  };
  // The sea's are in two pieces: what it emits and reflects of the sky, and the sun in it.
  [[nodiscard]] std::array<std::array<Rows, 2>, kCauses> cause_rows() const;

  SourceClasses classes_;
  bool sky_, lower_, parts_, direct_sun_;  // whether reflections see them
  int sun_index_;  // which sun of the path tracer shines in this condition; -1: none
  std::size_t nodes_;
  std::vector<std::vector<double>> part_, part_apparent_;  // blackbody radiance of each part
  std::vector<double> none_;
  std::vector<std::vector<double>> glint_, glint_apparent_;  // [kGlintCosines]
  const ViewEnvironment* environment_;
};

// One row for every source alike: radiance 1, weights that add up to 1.
[[nodiscard]] SourceTable unit_table(const SpectralBasis* basis, std::size_t first_node,
                                     std::span<const double> weight);

// Where evaluate() puts some of them.
inline constexpr std::size_t kEmittedQuantity = 1, kApparentQuantity = 1 + kCauses,
                             kAreaQuantity = 2 + kCauses;
[[nodiscard]] constexpr std::size_t contrast_quantity(std::size_t parts) {
  return kAreaQuantity + 1 + parts;
}

// How many numbers evaluate() gives.
[[nodiscard]] std::size_t quantities(std::size_t parts, const BandGrid& grid, bool spectra);

}  // namespace irsig
