#include "planning/machine.h"

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include "fmt/format.h"
#include "planning/prediction.h"

namespace irsig {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// The number in a file of one word; unlimited if there is none ("max").
double number_in(const std::string& path) {
  double number = 0;
  return std::ifstream(path) >> number ? number : kUnlimited;
}

// The number of the line that begins with this word; unlimited if there is none.
double number_after(const std::string& path, std::string_view word) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string name;
    double number = 0;
    if (words >> name >> number && name == word) return number;
  }
  return kUnlimited;
}

// cgroup v2: the limit of the group or of one that it lies in.
double left_by_groups_bytes() {
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("0::")) continue;
    double left = kUnlimited;
    for (std::string group = line.substr(3); !group.empty();
         group.resize(group == "/" ? 0 : std::max<std::size_t>(group.rfind('/'), 1))) {
      const std::string folder = "/sys/fs/cgroup" + group;
      const double most = number_in(folder + "/memory.max");
      const double taken = number_after(folder + "/memory.stat", "anon");  // not its file cache
      if (most < kUnlimited) left = std::min(left, taken < kUnlimited ? most - taken : most);
      if (group == "/") break;
    }
    return left;
  }
  return kUnlimited;
}

}  // namespace

std::uint32_t usable_cores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  if (sched_getaffinity(0, sizeof(cores), &cores) != 0) return 1;
  return static_cast<std::uint32_t>(std::max(1, CPU_COUNT(&cores)));
}

double usable_memory_bytes(std::uint32_t processes) {
  const double available = 1024 * number_after("/proc/meminfo", "MemAvailable:");
  double bytes = std::min(available, left_by_groups_bytes());
  for (const auto which : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit limit{};
    if (getrlimit(which, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      bytes = std::min(bytes, processes * static_cast<double>(limit.rlim_cur));
  }
  return bytes;
}

std::string memory_text(const JobMemory& memory, std::uint64_t conditions, std::uint32_t workers) {
  const std::string heat = memory.heat_bytes > 0 ? fmt::format("; {} for temperatures, before",
                                                               bytes_text(memory.heat_bytes))
                                                 : std::string();
  return fmt::format("about {} in each of {} worker{} ({} for each of {} condition{}{})",
                     bytes_text(memory.bytes(conditions)), workers, workers == 1 ? "" : "s",
                     bytes_text(memory.bytes_per_condition), conditions, conditions == 1 ? "" : "s",
                     heat);
}

absl::Status check_memory(const JobMemory& memory, std::uint64_t conditions, std::uint32_t workers,
                          double usable_bytes) {
  if (memory.bytes(conditions, workers) <= usable_bytes) return absl::OkStatus();
  std::string advice;
  const std::uint64_t with_all = memory.conditions_in(usable_bytes, workers);
  const std::uint64_t with_one = memory.conditions_in(usable_bytes, 1);
  if (with_all > 0)
    advice = fmt::format("{} condition{} would fit with {} worker{}", with_all,
                         with_all == 1 ? "" : "s", workers, workers == 1 ? "" : "s");
  if (workers > 1 && with_one > 0)
    advice += fmt::format("{}{} with --workers 1", advice.empty() ? "" : ", ", with_one);
  if (advice.empty())
    advice = memory.heat_bytes > std::max(0.0, usable_bytes - memory.fixed_bytes)
                 ? "its temperatures would not fit: fewer facets, or a larger heat.step_minutes"
                 : "not even one condition would fit";
  return absl::ResourceExhaustedError(
      fmt::format("the sweep needs {}, and {} of memory are free: {}; cut it into several sweeps",
                  memory_text(memory, conditions, workers), bytes_text(usable_bytes), advice));
}

}  // namespace irsig
