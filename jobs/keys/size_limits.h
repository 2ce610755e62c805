#pragma once

#include <cstddef>

namespace irsig {

// A text of a sweep or of a request that has no bound of its own (jobs/text/size_bounds.h). [bytes]
inline constexpr std::size_t kLongestName = 1000;

// Limits of one sweep in all: rows = viewpoints x conditions x bands, jobs, and rows of profiles
// under each signature.
inline constexpr double kMostRows = 1e8;
inline constexpr double kMostJobs = 2e6;
inline constexpr double kMostProfileRows = 1e6;

}  // namespace irsig
