#pragma once

#include "schema/sweep.pb.h"

namespace irsig {

// Returns the size [bytes] of the stored images of one row of a sweep with [image], with their
// layers, or of the images while they are made. 0 without [image].
[[nodiscard]] double image_bytes_of_row(const schema::Sweep& sweep);
[[nodiscard]] double image_memory_of_row(const schema::Sweep& sweep);

// Limit of the images of a job; it keeps them below the largest result that a coordinator accepts.
// [bytes]
inline constexpr double kMostImageBytes = 128e6;

// Returns the number of rows of a job whose images fit the limit; infinite without [image].
[[nodiscard]] double most_rows_with_images(const schema::Sweep& sweep);

}  // namespace irsig
