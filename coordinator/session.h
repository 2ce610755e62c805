#pragma once

#include <string_view>

namespace irsig {

// The life of a worker as the coordinator sees it, from its registration until it is lost. A lost
// worker that comes back registers anew.
enum class SessionState { kIdle, kComputing, kLost };

enum class SessionEvent {
  kAskForJob,
  kHeartbeat,         // with the token of its lease, or none while idle
  kForeignHeartbeat,  // with another token
  kReturn,            // completes or fails the job of its lease
  kForeignReturn,     // another token: late, or never its own
  kSilence,           // no word for longer than the lease timeout
  kSuccessor,         // somebody registered under its name
};

enum class SessionAction {
  kNone,
  kLease,             // give it a job: it becomes kComputing if there is one, else kIdle
  kReleaseThenLease,  // it has forgotten its job: back to the queue first
  kSettle,            // take what it returns
  kRelease,           // its job goes back to the queue
  kAnswerInvalid,     // tell it that the lease is not its own any more
  kRefuse,
};

struct SessionStep {
  SessionState next;
  SessionAction action;
  friend bool operator==(const SessionStep&, const SessionStep&) = default;
};

[[nodiscard]] SessionStep next(SessionState state, SessionEvent event);

}  // namespace irsig
