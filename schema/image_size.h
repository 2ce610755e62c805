#pragma once

#include "schema/sweep.pb.h"

namespace irsig {

// Returns what the images of one row of a sweep with [image] may take when they are stored, with
// their layers; and while they are made. 0 without [image]. [bytes]
[[nodiscard]] double image_bytes_of_row(const schema::Sweep& sweep);
[[nodiscard]] double image_memory_of_row(const schema::Sweep& sweep);

// Those of a job stay below the largest result that a coordinator takes.
inline constexpr double kMostImageBytes = 128e6;

// Rows of a job whose images are as many; infinitely many without [image].
[[nodiscard]] double most_rows_with_images(const schema::Sweep& sweep);

}  // namespace irsig
