#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "planning/load_sweep.h"
#include "view/accuracy_tables.h"

namespace irsig {

// Which rows of a sweep an accuracy study looks at.
struct AccuracyRows {
  std::optional<std::string> season, time, band;
  // Azimuth and elevation; none: the middle one of the sweep's viewpoints.
  std::optional<std::array<double, 2>> aspect_deg;
  double seconds = 60;  // CPU time for everything, roughly
  // > 0: so many primary rays instead, whatever the machine does besides.
  double primary_rays = 0;
};

// Traces the rows in every way that there is. INVALID_ARGUMENT: no such season, time or band.
[[nodiscard]] absl::StatusOr<std::vector<StudiedRow>> study_accuracy(const LoadedSweep& loaded,
                                                                     const AccuracyRows& rows);

}  // namespace irsig
