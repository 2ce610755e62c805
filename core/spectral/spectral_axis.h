#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/spectral/band.h"

namespace irsig {

// One band on an axis: its grid, and where on the axis its nodes begin.
struct BandOnAxis {
  const BandGrid& grid;
  std::size_t first_node;

  [[nodiscard]] std::size_t nodes() const { return grid.node_um.size(); }
};

// The wavelengths at which a sweep is computed: the nodes of all its bands, one band after the
// other. Spectra "on the sweep's nodes" have one value for each.
class SpectralAxis {
 public:
  SpectralAxis() = default;
  explicit SpectralAxis(std::vector<BandGrid> grids) : grid_(std::move(grids)) {
    for (const BandGrid& grid : grid_) {
      first_node_.push_back(node_um_.size());
      node_um_.insert(node_um_.end(), grid.node_um.begin(), grid.node_um.end());
    }
  }

  [[nodiscard]] const std::vector<double>& node_um() const { return node_um_; }
  [[nodiscard]] std::size_t nodes() const { return node_um_.size(); }
  [[nodiscard]] std::size_t bands() const { return grid_.size(); }
  [[nodiscard]] const std::vector<BandGrid>& grids() const { return grid_; }
  // Returns a band, which the axis outlives.
  [[nodiscard]] BandOnAxis band(std::size_t b) const { return {grid_[b], first_node_[b]}; }

 private:
  std::vector<BandGrid> grid_;
  std::vector<double> node_um_;
  std::vector<std::size_t> first_node_;  // [band]
};

}  // namespace irsig
