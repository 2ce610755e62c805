#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "planning/load_sweep.h"
#include "view/study_tables/accuracy_tables.h"

namespace irsig {

// The rows of a sweep for an accuracy study.
struct AccuracyRows {
  std::optional<std::string> season, time, band;
  // Azimuth and elevation; none: the middle one of the sweep's viewpoints.
  std::optional<std::array<double, 2>> aspect_deg;
  double seconds = 60;  // CPU time for everything, roughly
  //  0: this number of primary rays instead, whatever the load of the machine.
  double primary_rays = 0;
};

// The chosen rows as indices of the sweep's season, time and band. INVALID_ARGUMENT: the sweep has
// no such row.
struct ChosenRows {
  std::uint32_t condition = 0;
  std::vector<std::uint32_t> band;
};
[[nodiscard]] absl::StatusOr<ChosenRows> choose_rows(const schema::ResolvedSweep& sweep,
                                                     const AccuracyRows& rows);

// Traces the rows in every way that there is. INVALID_ARGUMENT: no such season, time or band.
[[nodiscard]] absl::StatusOr<std::vector<StudiedRow>> study_accuracy(const LoadedSweep& loaded,
                                                                     const AccuracyRows& rows);

}  // namespace irsig
