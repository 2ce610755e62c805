#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/client_socket.h"
#include "coordinator/frame_meter.h"
#include "coordinator/once_a_second.h"
#include "coordinator/visitors.h"

namespace irsig {

// State that the connections of a gate share. Belongs to the gate's thread.
struct RelayDesk {
  explicit RelayDesk(Visitors& registry) : visitors(registry) {}

  std::unique_ptr<ClientSockets> sockets;
  Visitors& visitors;
  FrameTotals totals{FrameLimits()};
  int most_fd = 0;                   // a descriptor with a higher number is given back at once
  std::function<void(int)> hand_on;  // gives the descriptor to gRPC
  int under_way = 0;                 // connections
  OnceASecond refused, silent, too_much, crowded;
  std::vector<char> scratch = std::vector<char>(64 << 10);  // between two waits one relay needs it
  boost::asio::io_context loop{1};  // the last member: its waiting calls use the others
};

// Serves a client until the relay ends. Takes over the client's descriptor, performs the handshake,
// makes a pair of sockets of which gRPC gets one, and carries bytes between the client and the
// other. The client's requests are checked against FrameLimits before gRPC receives them. A client
// that has sent nothing within `patience_ms` is disconnected.
void start_relay(RelayDesk& desk, int client_fd, std::string address, int patience_ms);

}  // namespace irsig
