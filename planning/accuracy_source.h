#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "planning/load_sweep.h"
#include "schema/store/reader.h"

namespace irsig {

// A sweep file, or a sweep stored in a database.
struct AccuracySource {
  LoadedSweep loaded;
  std::unique_ptr<StoreReader> database;  // null: a file
};

// Loads the sweep to study. sweep_name: needed if a database has several sweeps. INVALID_ARGUMENT:
// the database has none, or several and no name is given.
[[nodiscard]] absl::StatusOr<AccuracySource> load_accuracy_source(const std::string& path,
                                                                  const std::string& sweep_name);

}  // namespace irsig
