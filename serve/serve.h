#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
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

struct ServeOptions {
  std::vector<std::string> database;  // at least one; each is opened anew for every request
  std::vector<PageDetector> detector;
  std::string address = "127.0.0.1";  // an IP address, or localhost
  int port = 8017;                    // 0: one that is free
  ExtentOf extent_of;                 // for rows at another range
  FarmOf farm;                        // of their coordinator; empty: none is asked
  std::string accuracy_page;          // HTML, as irsig accuracy writes it; empty: none
  // Called once, when requests are answered: the page's address; what people must know besides.
  std::function<void(const std::string& url, const std::string& warning)> on_ready;
};

// Serves the page of signature databases until SIGINT or SIGTERM, which no other code of the
// process may handle. Only reads. The errors of StoreReader::open;
// INVALID_ARGUMENT: an address or port that is none; UNAVAILABLE: the port is taken.
[[nodiscard]] absl::Status serve(const ServeOptions& options);

}  // namespace irsig
