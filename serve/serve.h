#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "serve/page_sources.h"

namespace irsig {

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
