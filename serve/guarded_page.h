#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "serve/hosts.h"
#include "serve/page_reply.h"
#include "serve/target.h"

namespace irsig {

// A page of one process, which answers to whoever knows the secret in its address.
struct GuardedPage {
  std::string command;         // that printed the address, for words: "irsig serve"
  std::string address;         // an IP address, or localhost
  int port = 0;                // 0: one that is free
  bool loopback_only = false;  // whether other addresses are refused
  // Called by several threads at once, with what lies below the secret.
  std::function<PageReply(const RequestTarget&)> answer;
  // Called once, when requests are answered.
  std::function<void(const std::string& url, const ListenAddress& address)> on_ready;
};

// Serves until SIGINT or SIGTERM, which no other code of the process may handle. INVALID_ARGUMENT:
// an address or port that is none; UNAVAILABLE: the port is taken.
[[nodiscard]] absl::Status serve_guarded(const GuardedPage& page);

}  // namespace irsig
