#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "schema/farm.pb.h"

namespace irsig {

// Observed progress of a running sweep: enough for rates without the jobs that were done before.
struct ProgressView {
  double elapsed_s = 0;           // since temperatures, if there are any to compute, were known
  std::uint64_t done_before = 0;  // jobs and rays that this run found done
  std::uint64_t rays_before = 0;
  std::uint32_t workers = 0;
};

// Returns the progress of a sweep as one line without a line feed. While jobs compute the
// temperatures that views need: "temperatures 1 of 2, then 191 views"; later: "jobs 57/191  2.1
// Mrays/s  1:23 left  worst error 0.12 %".
[[nodiscard]] std::string progress_text(const schema::SweepStatus& sweep, const ProgressView& view);

// Returns the number of settled jobs: done, failed for good or cancelled.
[[nodiscard]] std::uint64_t settled_jobs(const schema::SweepStatus& sweep);

// Reports the progress of one sweep since its first call of text().
class SweepWatch {
 public:
  // Returns the progress at a time [s] of any clock that does not jump.
  [[nodiscard]] std::string text(const schema::SweepStatus& sweep, std::uint32_t workers,
                                 double seconds);

 private:
  bool rated_ = false;  // something but temperatures is being computed
  double start_s_ = 0;
  ProgressView view_;
};

// Returns the name of a state: "idle", "computing" or "set aside". Empty: this version does not
// know the state.
[[nodiscard]] std::string_view state_name(schema::WorkerStatus::State state);

// Formats a duration: "1:23", "2:03:04".
[[nodiscard]] std::string duration_text(double seconds);

// Formats a count with three significant digits: "3.2 Mrays".
[[nodiscard]] std::string count_text(double count, std::string_view noun);

}  // namespace irsig
