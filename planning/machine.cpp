#include "planning/machine.h"

#include <sched.h>

#include <algorithm>

#include "fmt/format.h"
#include "planning/amount_text.h"

namespace irsig {
std::uint32_t usable_cores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  if (sched_getaffinity(0, sizeof(cores), &cores) != 0) return 1;
  return static_cast<std::uint32_t>(std::max(1, CPU_COUNT(&cores)));
}

std::string memory_text(const JobMemory& memory, std::uint64_t conditions, std::uint32_t workers) {
  const std::string heat = memory.heat_bytes > 0 ? fmt::format("; {} for temperatures, before",
                                                               bytes_text(memory.heat_bytes))
                                                 : std::string();
  const std::string together =
      workers > 1
          ? fmt::format(", {} with {}", bytes_text(memory.bytes(conditions, workers)), workers)
          : std::string();
  return fmt::format("about {} with 1 worker{} ({} for each of {} condition{}{})",
                     bytes_text(memory.bytes(conditions)), together,
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
