#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/study/stated_errors.h"
#include "planning/accuracy_source.h"

namespace irsig {

// First line of a check: the errors that the longer run shares with the rows, so that no comparison
// of the two can show them.
inline constexpr const char* kNotSeenByLongerRun =
    "not seen here, because the longer run shares it: facets and ray tracer, formulas and tables "
    "of "
    "materials, sun and air, quadrature over wavelength, sky and sea between their directions, one "
    "range for the target's depth, effects that are off, reflections after the last one, the "
    "horizon; `irsig selftest --search` judges these by other means";

struct ErrorCheckAsked {
  std::uint64_t views = 0;    // 0: all that have rows
  double times = 100;         // as many samples as the rows' own runs
  std::uint32_t workers = 0;  // threads; 0: one for each core
};

// One of the views, reported as soon as it is done.
struct CheckedViewpoint {
  std::size_t done, of;
  std::uint32_t viewpoint;
  double samples;  // primary rays of the longer run
  StatedErrorSummary intensity;
};

struct CheckedDatabase {
  std::vector<StatedRow> rows;
  std::size_t views = 0;
  double times = 0;  // by how much the longer runs were longer, at least
};

// Traces the views of a database again, with much longer runs and other random numbers, and
// compares the stored values with them. Several threads call `seen`, one at a time.
// INVALID_ARGUMENT: no rows. FAILED_PRECONDITION: the database is of another version.
[[nodiscard]] absl::StatusOr<CheckedDatabase> check_database_errors(
    AccuracySource& source, const ErrorCheckAsked& asked,
    const std::function<void(const CheckedViewpoint&)>& seen);

}  // namespace irsig
