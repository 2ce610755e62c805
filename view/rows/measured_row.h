#pragma once

#include "core/accuracy/measured.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Returns one of a stored row's three intensities, with its bounds separated. Rows of older formats
// did not store every bound; the remainder of their numerical error is assigned to the first
// missing bound.
[[nodiscard]] Measured source_of(const StoredSignature& row);
[[nodiscard]] Measured apparent_of(const StoredSignature& row);
[[nodiscard]] Measured contrast_of(const StoredSignature& row);

// Bounds as they are stored: kNotComputed where the row's format did not keep one.
enum class IntensityOf { kSource, kApparent, kContrast };
[[nodiscard]] double stored_bound(const StoredSignature& row, IntensityOf intensity, BoundOf which);
[[nodiscard]] double stored_undersampling_stderr(const StoredSignature& row, IntensityOf intensity);

}  // namespace irsig
