#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/functional/any_invocable.h"
#include "absl/status/status.h"
#include "coordinator/farm.h"
#include "schema/store/writer.h"

namespace irsig {

// Returns true if an error refuses one request only. Changes that the refused request wrote (a
// counted failure, for example) are kept.
[[nodiscard]] inline bool is_refusal(const absl::Status& status) {
  return absl::IsFailedPrecondition(status) || absl::IsInvalidArgument(status) ||
         absl::IsNotFound(status) || absl::IsAlreadyExists(status) || absl::IsAborted(status);
}

// The one thread that owns the farm and its store. Requests that arrive during a commit wait and
// then share the next one (group commit), so that a busy coordinator needs fewer commits per
// request. Any thread may call post(); the other members belong to the thread that made the loop.
class CommitLoop {
 public:
  // kLeases: the request writes which worker has which job, which need not survive a failure of the
  // machine.
  enum class Kind { kReads, kLeases, kWrites };
  using Work = absl::AnyInvocable<absl::Status(Farm&)>;
  using Acknowledge = absl::AnyInvocable<void(const absl::Status&)>;

  ~CommitLoop();

  // Queues a request: `work` runs on the loop's thread, and `acknowledge` gets its status after the
  // commit.
  void post(Kind kind, Work work, Acknowledge acknowledge);

  // Starts to serve the requests. A request that fails otherwise than by a refusal (an exception, a
  // statement that cannot run) is undone alone, and the others continue. If the store cannot
  // continue (the disk is full), `failed` is called once, and no later request is acknowledged.
  void start(Farm& farm, StoreWriter& store, absl::AnyInvocable<void(absl::Status)> failed);
  // Serves the waiting requests and ends.
  void stop();

 private:
  struct Request {
    Kind kind;
    Work work;
    Acknowledge acknowledge;
    absl::Status status;
  };
  void run(Farm& farm, StoreWriter& store);
  std::vector<Request> wait_for_requests();
  absl::Status serve(Farm& farm, StoreWriter& store, std::vector<Request>& requests);

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Request> waiting_;
  bool stopping_ = false;
  absl::Status broken_;
  absl::AnyInvocable<void(absl::Status)> failed_;
  std::thread thread_;
};

}  // namespace irsig
