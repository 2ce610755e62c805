#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace irsig {

// The client of a connection.
struct Visitor {
  std::string address;      // for people: "192.0.2.7:40312", "unix"
  std::string certificate;  // in PEM; empty without TLS
};

// Clients of the connections that a gate has handed to gRPC, by gRPC's name of the connection
// (ServerContext::peer()). No name is given twice. Thread-safe.
class Visitors {
 public:
  void enter(const std::string& peer, Visitor visitor) {
    const std::lock_guard lock(mutex_);
    there_.emplace(peer, std::move(visitor));
  }
  void leave(const std::string& peer) {
    const std::lock_guard lock(mutex_);
    there_.erase(peer);
  }
  // Returns the visitor with this address. nullopt: the connection has ended.
  [[nodiscard]] std::optional<Visitor> find(const std::string& peer) const {
    const std::lock_guard lock(mutex_);
    const auto found = there_.find(peer);
    return found == there_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Visitor> there_;
};

}  // namespace irsig
