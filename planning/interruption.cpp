#include "planning/interruption.h"

#include <atomic>
#include <csignal>

namespace irsig {
namespace {
std::atomic<bool> came = false;
}

void hear_interruptions() {
  std::signal(SIGINT, [](int) { came = true; });
  std::signal(SIGTERM, [](int) { came = true; });
  std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() { return came; }

}  // namespace irsig
