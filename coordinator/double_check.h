#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace irsig {

// A job of a sweep.
struct JobName {
  std::string sweep_sha256, job_key;
  friend auto operator<=>(const JobName&, const JobName&) = default;
};

// Chooses jobs to be computed by a second worker, and judges results that differ. A hash that no
// worker knows in advance selects the chosen fraction of jobs. If two results differ, a third
// worker's result decides; until then neither worker is blamed. The state is in memory alone and
// lost when the coordinator restarts. Not thread-safe.
class DoubleCheck {
 public:
  // share: fraction of all jobs. salt: differs at every start of the coordinator.
  DoubleCheck(double share, std::string salt) : share_(share), salt_(std::move(salt)) {}

  // Returns true if another worker is to compute the job again after its first result. ask_for()
  // requests such a computation by a worker that is not in `not_by`.
  [[nodiscard]] bool chosen(const JobName& job) const;
  void ask_for(const JobName& job, std::set<std::string> not_by);
  // Returns a requested job that this worker may compute, and removes the job from the list.
  // nullopt: there is none.
  [[nodiscard]] std::optional<JobName> next_for(const std::string& worker);

  struct Verdict {
    enum class Kind {
      kUndecided,     // a third worker is asked, now or when it comes
      kOneIsWrong,    // two agree with the stored result: `wrong` is set aside
      kStoredIsWrong  // two agree on another result: `wrong` computed the stored one
    } kind;
    std::string wrong;
  };
  // Records a second result: agrees() if it equals the stored result, differs() if not. nullopt:
  // all results of the job agree.
  std::optional<Verdict> agrees(const JobName& job, const std::string& content);
  Verdict differs(const JobName& job, const std::string& stored_content,
                  const std::string& stored_by, const std::string& content,
                  const std::string& worker);

  [[nodiscard]] std::uint64_t audited() const { return audited_; }

 private:
  struct Wanted {
    JobName job;
    std::set<std::string> not_by;
  };
  double share_;
  std::string salt_;
  std::deque<Wanted> wanted_;
  std::map<JobName, std::map<std::string, std::string>>
      others_;  // content -> whose, beside the stored
  std::uint64_t audited_ = 0;
};

// Detects jobs that take too long, from the times of recent jobs. Times in seconds of the farm's
// clock.
class Stragglers {
 public:
  void took(double seconds);
  // Returns true if a job with this computing time deserves a second, idle worker: the time exceeds
  // twice the recent typical time, and is long enough for a second worker to save time.
  [[nodiscard]] bool is_one(double seconds) const {
    return known_ > 0 && seconds > 2 * typical_s_ && seconds > kShortest_s;
  }

 private:
  static constexpr double kShortest_s = 1;
  static constexpr double kRemembered = 20;  // jobs
  double typical_s_ = 0, known_ = 0;
};

// Rate of recent events per second. Times as above.
class Rate {
 public:
  void happened(double now_s) {
    at_s_.push_back(now_s);
    if (at_s_.size() > kMost) at_s_.pop_front();
  }
  // Returns the rate [1/s]. 0: there were too few events, or the last one is too long ago.
  [[nodiscard]] double per_s(double now_s) const {
    if (at_s_.size() < 2 || now_s - at_s_.back() > kLongAgo_s || !(now_s > at_s_.front())) return 0;
    return static_cast<double>(at_s_.size() - 1) / (now_s - at_s_.front());
  }

 private:
  static constexpr std::size_t kMost = 200;
  static constexpr double kLongAgo_s = 3600;
  std::deque<double> at_s_;
};

}  // namespace irsig
