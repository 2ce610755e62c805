#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "runner/job_runner.h"

namespace irsig {

// The runners of the lease loops of one process. Loops that compute the same sweep share one
// runner: one scene, one set of air, sky and sunlight, one copy of the temperatures. A runner is
// destroyed with the last loop that uses it. Thread-safe.
class SharedRunners {
 public:
  struct Key {
    std::string sweep_sha256;
    std::vector<std::string>
        outputs;  // hashes of the outputs of its heat jobs; none: not yet there
  };
  // assets: by hash, those of the previous sweep; make leaves those of its own sweep there.
  using Make = std::function<absl::StatusOr<std::unique_ptr<const JobRunner>>(Assets& assets)>;

  // Returns the runner of this sweep that another loop uses, or a new one by `make`, for which
  // other loops wait. A runner made before the outputs existed serves requests without outputs.
  [[nodiscard]] absl::StatusOr<std::shared_ptr<const JobRunner>> get(const Key& key,
                                                                     const Make& make);
  // Forgets a runner after a failure; the next request makes a new one.
  void forget(const std::shared_ptr<const JobRunner>& runner);

 private:
  std::mutex mutex_;
  std::vector<std::pair<Key, std::weak_ptr<const JobRunner>>> known_;
  Assets assets_;
};

}  // namespace irsig
