#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/materials/material.h"

namespace irsig {

// A few of the spectral nodes, at which paths carry their factors, and how every other node follows
// from them: empirical interpolation. [barrault2004]
//
// What a path carries is a product of rows of the materials' tables (brdf factors at the angles of
// its reflections, the emissivity of its end). Such products span few dimensions: g(every node) =
// expand x g(carried nodes) within relative_error x (its largest value / the fraction of the weight
// that its reflections leave). The division is there because a path that has been reflected often
// is rare by the same fraction: seen as a share of all that is met first, the error is
// relative_error for emission and for every number of reflections alike. The nodes are chosen one
// after the other where the worst of a fixed set of random products is interpolated worst; the
// error is the largest found on other random products of up to 12 reflections. Linear, so that what
// is true of each path is true of any sum of paths.
struct SpectralBasis {
  std::size_t nodes = 0;               // all
  std::vector<std::uint32_t> carried;  // which of them paths carry
  std::vector<double> expand;          // [node][carried]; empty: every node is carried
  double relative_error = 0;           // measured; 0 if every node is carried

  [[nodiscard]] std::size_t columns() const { return carried.size(); }
  [[nodiscard]] bool identity() const { return expand.empty(); }

  // Weights at the carried nodes -> at nodes [first, first + out.size()).
  void to_nodes(const double* carried_weight, std::size_t first, std::span<double> out) const;
  // Applies the transpose: sum over nodes of values[i] x (weight at node first + i) = sum over
  // carried of the result x carried weight.
  [[nodiscard]] std::vector<double> fold(std::size_t first, std::span<const double> values) const;
};

// Returns the basis for materials prepared at every node. Every node is carried where the basis
// would need more than half of the nodes, or if there are at most 8 nodes.
[[nodiscard]] SpectralBasis make_spectral_basis(std::span<const Material> materials,
                                                double tolerance = 1e-5);

}  // namespace irsig
