#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/materials/material_spec.h"

namespace irsig {

// Values at a wavelength, linear between a table's points and constant beyond its ends.
[[nodiscard]] double spectrum_at(const Spectrum& table, double lambda_um);
[[nodiscard]] OpticalConstant constants_at(const OpticalConstants& table, double lambda_um);

// Returns INVALID_ARGUMENT unless the table has one point, or increasing ones that cover the
// wavelengths.
[[nodiscard]] absl::Status check_covers(const OpticalConstants& table, double lambda_min_um,
                                        double lambda_max_um);
// Like check_covers(), and requires every value in [0, 1].
[[nodiscard]] absl::Status check_fraction(const Spectrum& table, const char* what,
                                          double lambda_min_um, double lambda_max_um);
// Returns INVALID_ARGUMENT unless least <= value <= most.
[[nodiscard]] absl::Status check_between(double value, const char* what, double least, double most);

// The fewest wavelengths at which the tables of a material bend: between them the tables differ
// from straight lines by at most a tolerance. The tolerance is absolute for emissivities and
// reflectances, and relative to |n + ik| for optical constants. A table of a BRDF keeps all of its
// wavelengths.
struct TableCorners {
  std::vector<double> um;  // increasing
  double left_out = 0;     // by how much the tables differ from the lines at most; <= tolerance
};
[[nodiscard]] TableCorners table_corners(const MaterialSpec& material, double from_um, double to_um,
                                         double tolerance);

// Returns the first failure of several, or ok.
[[nodiscard]] absl::Status first_failure(std::vector<absl::Status> statuses);

}  // namespace irsig
