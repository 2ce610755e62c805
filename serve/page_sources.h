#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/detector/detector.h"
#include "view/query/query.h"

namespace irsig {

struct PageDetector {
  std::string path, name;  // of its file
  Detector detector;
};

// A worker of a coordinator, at the time of the question.
struct PageWorker {
  std::string name, state;                         // idle, computing, set aside
  std::optional<double> job_s;                     // it computes its job for so long
  std::string job_key, determinism_class, reason;  // why it was set aside
  std::uint64_t memory_bytes = 0;                  // 0: not known
};
struct PageFarm {
  std::uint64_t workers = 0;  // of all; some of them:
  std::vector<PageWorker> worker;
  std::vector<std::string> warning;
};
// Errors are shown as words.
using FarmOf = std::function<absl::StatusOr<PageFarm>()>;

// The databases of a page and what else it shows: the same as in ServeOptions.
struct PageSources {
  std::vector<std::string> database;  // paths, as they were named
  std::vector<PageDetector> detector;
  ExtentOf extent_of;
  FarmOf farm = {};
  std::string accuracy_page = {};
};

}  // namespace irsig
