#pragma once

#include <vector>

namespace irsig {

// Eigenvalues and eigenvectors of a symmetric, positive semidefinite matrix, by cyclic Jacobi
// rotations, the largest eigenvalue first. [golub2013, alg. 8.4.3] The component of largest
// magnitude of each vector is positive. Elements off the diagonal that are below `negligible` x the
// trace stay.
struct SymmetricEigen {
  std::vector<double> value;
  std::vector<std::vector<double>> vector;  // [eigenvalue][component]
};
[[nodiscard]] SymmetricEigen symmetric_eigen(std::vector<std::vector<double>> matrix,
                                             double negligible);

}  // namespace irsig
