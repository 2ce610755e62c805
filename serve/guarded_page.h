#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "serve/hosts.h"
#include "serve/page_reply.h"
#include "serve/target.h"

namespace irsig {

// A page of one process, which answers clients that know the secret in its address.
struct GuardedPage {
  std::string command;         // that printed the address, for words: "irsig serve"
  std::string address;         // an IP address, or localhost
  int port = 0;                // 0: one that is free
  bool loopback_only = false;  // whether other addresses are refused
  // Callback, called by several threads at once, with the part of the path below the secret.
  std::function<PageReply(const RequestTarget&)> answer;
  // Called once, when requests are answered.
  std::function<void(const std::string& url, const ListenAddress& address)> on_ready;
};

// Serves until SIGINT or SIGTERM, which no other code of the process may handle. INVALID_ARGUMENT:
// the address or port is invalid. UNAVAILABLE: the port is in use.
[[nodiscard]] absl::Status serve_guarded(const GuardedPage& page);

}  // namespace irsig
