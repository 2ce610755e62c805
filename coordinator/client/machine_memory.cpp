#include "coordinator/client/machine_memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>

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

double usable_memory_bytes() {
  const double available = 1024 * number_after("/proc/meminfo", "MemAvailable:");
  double bytes = std::min(available, left_by_groups_bytes());
  for (const auto which : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit limit{};
    if (getrlimit(which, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      bytes = std::min(bytes, static_cast<double>(limit.rlim_cur));
  }
  return bytes;
}

}  // namespace irsig
