#include "view/base/on_all_cores.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>
#include <vector>

namespace irsig {

absl::Status on_all_cores(std::size_t count, const std::function<absl::Status(std::size_t)>& work) {
  std::vector<absl::Status> status(count);
  std::atomic<std::size_t> next = 0;
  const auto loop = [&] {
    for (std::size_t i = next++; i < count; i = next++) status[i] = work(i);
  };
  {
    std::vector<std::jthread> others;
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    for (std::size_t t = 1; t < std::min(cores, count); ++t) others.emplace_back(loop);
    loop();
  }
  for (absl::Status& s : status)
    if (!s.ok()) return std::move(s);
  return absl::OkStatus();
}

}  // namespace irsig
