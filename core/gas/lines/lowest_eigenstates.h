#pragma once

#include <cstddef>
#include <vector>

namespace irsig {

// Lowest eigenvalues and eigenvectors of a real symmetric matrix.
struct LowestEigenstates {
  std::vector<double> value;   // increasing
  std::vector<double> vector;  // [n * size + i], orthonormal rows
};

// Householder reduction, implicit QL for the values, inverse iteration for the vectors.
//   a         [i * size + j], symmetric; overwritten
//   at_most   values above it are left out
[[nodiscard]] LowestEigenstates lowest_eigenstates(std::vector<double>& a, std::size_t size,
                                                   double at_most);

}  // namespace irsig
