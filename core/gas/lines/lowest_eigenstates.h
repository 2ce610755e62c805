#pragma once

#include <cstddef>
#include <vector>

namespace irsig {

// Lowest eigenvalues and eigenvectors of a real symmetric matrix.
struct LowestEigenstates {
  std::vector<double> value;   // increasing
  std::vector<double> vector;  // [n * size + i], orthonormal rows
};

// Computes the eigenstates with the lowest eigenvalues of a symmetric matrix.
//   a        [i * size + j]
//   at_most  larger eigenvalues are left out
[[nodiscard]] LowestEigenstates lowest_eigenstates(const std::vector<double>& a, std::size_t size,
                                                   double at_most);

}  // namespace irsig
