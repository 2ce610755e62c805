#pragma once

#include "core/accuracy/measured.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// A stored row's three intensities with their bounds apart. Rows of older formats did not keep
// every bound: what their numerical error holds besides is given to the first bound that they lack.
[[nodiscard]] Measured source_of(const StoredSignature& row);
[[nodiscard]] Measured apparent_of(const StoredSignature& row);
[[nodiscard]] Measured contrast_of(const StoredSignature& row);

// Bounds as they are stored: kNotComputed where the row's format did not keep one.
enum class IntensityOf { kSource, kApparent, kContrast };
[[nodiscard]] double stored_bound(const StoredSignature& row, IntensityOf intensity, BoundOf which);
[[nodiscard]] double stored_undersampling_stderr(const StoredSignature& row, IntensityOf intensity);

}  // namespace irsig
