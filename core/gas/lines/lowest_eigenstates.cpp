#include "core/gas/lines/lowest_eigenstates.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/base/check.h"

namespace irsig {

LowestEigenstates lowest_eigenstates(const std::vector<double>& a, std::size_t size,
                                     double at_most) {
  IRSIG_CHECK(a.size() == size * size);
  LowestEigenstates out;
  if (size == 0) return out;
  const auto n = static_cast<Eigen::Index>(size);
  // Symmetric, so that rows may be read as columns.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::Map<const Eigen::MatrixXd>(a.data(), n, n));
  IRSIG_CHECK(solver.info() == Eigen::Success);
  const double* value = solver.eigenvalues().data();
  out.value.assign(value, std::upper_bound(value, value + size, at_most));
  const double* vector = solver.eigenvectors().data();  // column by column
  out.vector.assign(vector, vector + out.value.size() * size);
  return out;
}

}  // namespace irsig
