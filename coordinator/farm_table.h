#pragma once

#include "schema/store/tables/rows.h"

namespace irsig {

// The complete life of jobs and workers. Every event at a coordinator is one row below, and the
// farm looks up its decisions here. unit.queue (FarmWalk) compares farm and store with the table,
// row by row, over every state that two workers and two jobs can have.
//
// A lease joins a leased job and a computing worker by a fencing token. It states who computes a
// job, but not whose result is accepted. A result is accepted by its properties (sweep, job key,
// determinism class, content), from any registered worker. A worker may therefore compute without a
// lease: its job was given to another worker, or it computes a job for the second time (an audit,
// or because another worker takes long).

// ---------------------------------------------------------------------------------------------------
// Jobs. Their states are in the database, and survive whatever is killed.

enum class JobEvent {
  kLease,    // a worker requests a job
  kResult,   // a result arrives, from any worker
  kRelease,  // its lease ends without anything: the worker is lost, or the coordinator started
             // again
  kFail,     // its worker reports a failure; the job is tried again
  kGiveUp,   // the same, for the last time; or a job that it needs was given up
  kCancel,   // of its sweep
  kSubmit    // its sweep again
};

enum class JobAction {
  kNone,
  kStore,    // the result, in one transaction with the new state; a lease that runs ends
  kCompare,  // compare with the stored result: equal, or a conflict
  kDrop,     // discard the result
  kRefuse    // cannot be: nothing changes
};

struct JobRow {
  JobState state;
  JobEvent event;
  JobState next;
  JobAction action;
};

inline constexpr JobRow kJobTable[] = {
    {JobState::kWaiting, JobEvent::kLease, JobState::kLeased, JobAction::kNone},
    {JobState::kWaiting, JobEvent::kResult, JobState::kDone, JobAction::kStore},  // from a spool
    {JobState::kWaiting, JobEvent::kRelease, JobState::kWaiting, JobAction::kRefuse},
    {JobState::kWaiting, JobEvent::kFail, JobState::kWaiting, JobAction::kRefuse},
    {JobState::kWaiting, JobEvent::kGiveUp, JobState::kQuarantined, JobAction::kNone},
    {JobState::kWaiting, JobEvent::kCancel, JobState::kCancelled, JobAction::kNone},
    {JobState::kWaiting, JobEvent::kSubmit, JobState::kWaiting, JobAction::kNone},

    {JobState::kLeased, JobEvent::kLease, JobState::kLeased, JobAction::kRefuse},
    {JobState::kLeased, JobEvent::kResult, JobState::kDone, JobAction::kStore},
    {JobState::kLeased, JobEvent::kRelease, JobState::kWaiting, JobAction::kNone},
    {JobState::kLeased, JobEvent::kFail, JobState::kWaiting, JobAction::kNone},
    {JobState::kLeased, JobEvent::kGiveUp, JobState::kQuarantined, JobAction::kNone},
    {JobState::kLeased, JobEvent::kCancel, JobState::kCancelled, JobAction::kNone},
    {JobState::kLeased, JobEvent::kSubmit, JobState::kLeased, JobAction::kNone},

    {JobState::kDone, JobEvent::kLease, JobState::kDone, JobAction::kRefuse},
    {JobState::kDone, JobEvent::kResult, JobState::kDone, JobAction::kCompare},
    {JobState::kDone, JobEvent::kRelease, JobState::kDone, JobAction::kRefuse},
    {JobState::kDone, JobEvent::kFail, JobState::kDone, JobAction::kRefuse},
    {JobState::kDone, JobEvent::kGiveUp, JobState::kDone, JobAction::kRefuse},
    {JobState::kDone, JobEvent::kCancel, JobState::kDone, JobAction::kNone},
    {JobState::kDone, JobEvent::kSubmit, JobState::kDone, JobAction::kNone},

    {JobState::kQuarantined, JobEvent::kLease, JobState::kQuarantined, JobAction::kRefuse},
    {JobState::kQuarantined, JobEvent::kResult, JobState::kDone, JobAction::kStore},
    {JobState::kQuarantined, JobEvent::kRelease, JobState::kQuarantined, JobAction::kRefuse},
    {JobState::kQuarantined, JobEvent::kFail, JobState::kQuarantined, JobAction::kRefuse},
    {JobState::kQuarantined, JobEvent::kGiveUp, JobState::kQuarantined, JobAction::kRefuse},
    {JobState::kQuarantined, JobEvent::kCancel, JobState::kQuarantined, JobAction::kNone},
    {JobState::kQuarantined, JobEvent::kSubmit, JobState::kWaiting, JobAction::kNone},

    {JobState::kCancelled, JobEvent::kLease, JobState::kCancelled, JobAction::kRefuse},
    {JobState::kCancelled, JobEvent::kResult, JobState::kCancelled, JobAction::kDrop},
    {JobState::kCancelled, JobEvent::kRelease, JobState::kCancelled, JobAction::kRefuse},
    {JobState::kCancelled, JobEvent::kFail, JobState::kCancelled, JobAction::kRefuse},
    {JobState::kCancelled, JobEvent::kGiveUp, JobState::kCancelled, JobAction::kRefuse},
    {JobState::kCancelled, JobEvent::kCancel, JobState::kCancelled, JobAction::kNone},
    {JobState::kCancelled, JobEvent::kSubmit, JobState::kWaiting, JobAction::kNone},
};

// ---------------------------------------------------------------------------------------------------
// Workers, from their registration until they are lost. Their states are in memory: after a restart
// of the coordinator every worker is unknown, which is kLost, and registers anew.

enum class SessionState { kIdle, kComputing, kAside, kLost };

enum class SessionEvent {
  kAskForJob,
  kHeartbeat,         // with the token of its lease, or none while idle
  kForeignHeartbeat,  // with another token
  kResult,            // of the job that it was given
  kOtherResult,       // of another one: it was kept in a spool
  kFailure,           // of the job that it was given
  kForeignFailure,    // of another one
  kSilence,           // no word for longer than the lease timeout
  kSuccessor,         // somebody registered under its name
  kDistrust           // its results differ from others', or others do what it fails at
};

enum class SessionAction {
  kNone,
  kLease,             // give it a job: it becomes kComputing if there is one, else kIdle
  kReleaseThenLease,  // it has forgotten its job: back to the queue first
  kTake,              // the result goes to its job: kJobTable, kResult
  kCountFailure,      // kFail or kGiveUp of its job
  kRelease,           // kRelease of its job
  kAnswerInvalid,     // tell it that the lease is not its own any more
  kRefuse
};

struct SessionRow {
  SessionState state;
  SessionEvent event;
  SessionState next;
  SessionAction action;
};

inline constexpr SessionRow kSessionTable[] = {
    {SessionState::kIdle, SessionEvent::kAskForJob, SessionState::kIdle, SessionAction::kLease},
    {SessionState::kIdle, SessionEvent::kHeartbeat, SessionState::kIdle, SessionAction::kNone},
    {SessionState::kIdle, SessionEvent::kForeignHeartbeat, SessionState::kIdle,
     SessionAction::kAnswerInvalid},
    {SessionState::kIdle, SessionEvent::kResult, SessionState::kIdle, SessionAction::kTake},
    {SessionState::kIdle, SessionEvent::kOtherResult, SessionState::kIdle, SessionAction::kTake},
    {SessionState::kIdle, SessionEvent::kFailure, SessionState::kIdle, SessionAction::kRefuse},
    {SessionState::kIdle, SessionEvent::kForeignFailure, SessionState::kIdle,
     SessionAction::kRefuse},
    {SessionState::kIdle, SessionEvent::kSilence, SessionState::kLost, SessionAction::kNone},
    {SessionState::kIdle, SessionEvent::kSuccessor, SessionState::kLost, SessionAction::kNone},
    {SessionState::kIdle, SessionEvent::kDistrust, SessionState::kAside, SessionAction::kNone},

    {SessionState::kComputing, SessionEvent::kAskForJob, SessionState::kIdle,
     SessionAction::kReleaseThenLease},
    {SessionState::kComputing, SessionEvent::kHeartbeat, SessionState::kComputing,
     SessionAction::kNone},
    {SessionState::kComputing, SessionEvent::kForeignHeartbeat, SessionState::kComputing,
     SessionAction::kAnswerInvalid},
    {SessionState::kComputing, SessionEvent::kResult, SessionState::kIdle, SessionAction::kTake},
    {SessionState::kComputing, SessionEvent::kOtherResult, SessionState::kComputing,
     SessionAction::kTake},
    {SessionState::kComputing, SessionEvent::kFailure, SessionState::kIdle,
     SessionAction::kCountFailure},
    {SessionState::kComputing, SessionEvent::kForeignFailure, SessionState::kComputing,
     SessionAction::kRefuse},
    {SessionState::kComputing, SessionEvent::kSilence, SessionState::kLost,
     SessionAction::kRelease},
    {SessionState::kComputing, SessionEvent::kSuccessor, SessionState::kLost,
     SessionAction::kRelease},
    {SessionState::kComputing, SessionEvent::kDistrust, SessionState::kAside,
     SessionAction::kRelease},

    {SessionState::kAside, SessionEvent::kAskForJob, SessionState::kAside, SessionAction::kRefuse},
    {SessionState::kAside, SessionEvent::kHeartbeat, SessionState::kAside,
     SessionAction::kAnswerInvalid},
    {SessionState::kAside, SessionEvent::kForeignHeartbeat, SessionState::kAside,
     SessionAction::kAnswerInvalid},
    {SessionState::kAside, SessionEvent::kResult, SessionState::kAside, SessionAction::kRefuse},
    {SessionState::kAside, SessionEvent::kOtherResult, SessionState::kAside,
     SessionAction::kRefuse},
    {SessionState::kAside, SessionEvent::kFailure, SessionState::kAside, SessionAction::kRefuse},
    {SessionState::kAside, SessionEvent::kForeignFailure, SessionState::kAside,
     SessionAction::kRefuse},
    {SessionState::kAside, SessionEvent::kSilence, SessionState::kLost, SessionAction::kNone},
    {SessionState::kAside, SessionEvent::kSuccessor, SessionState::kLost, SessionAction::kNone},
    {SessionState::kAside, SessionEvent::kDistrust, SessionState::kAside, SessionAction::kNone},

    {SessionState::kLost, SessionEvent::kAskForJob, SessionState::kLost, SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kHeartbeat, SessionState::kLost, SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kForeignHeartbeat, SessionState::kLost,
     SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kResult, SessionState::kLost, SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kOtherResult, SessionState::kLost, SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kFailure, SessionState::kLost, SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kForeignFailure, SessionState::kLost,
     SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kSilence, SessionState::kLost, SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kSuccessor, SessionState::kLost, SessionAction::kRefuse},
    {SessionState::kLost, SessionEvent::kDistrust, SessionState::kLost, SessionAction::kRefuse},
};

// ---------------------------------------------------------------------------------------------------

// Returns the row of a state and an event. Both tables have every pair exactly once, which is
// checked at compile time.
template <class Row, std::size_t rows, class State, class Event>
[[nodiscard]] constexpr const Row& row_of(const Row (&table)[rows], State state, Event event) {
  std::size_t at = 0;
  while (table[at].state != state || table[at].event != event) ++at;  // beyond the end: no row
  return table[at];
}
[[nodiscard]] constexpr const JobRow& next(JobState state, JobEvent event) {
  return row_of(kJobTable, state, event);
}
[[nodiscard]] constexpr const SessionRow& next(SessionState state, SessionEvent event) {
  return row_of(kSessionTable, state, event);
}

inline constexpr int kJobStates = 5, kJobEvents = 7, kSessionStates = 4, kSessionEvents = 10;
static_assert(std::size(kJobTable) == kJobStates * kJobEvents);
static_assert(std::size(kSessionTable) == kSessionStates * kSessionEvents);
static_assert([] {
  for (int state = 0; state < kJobStates; ++state)
    for (int event = 0; event < kJobEvents; ++event)
      static_cast<void>(next(static_cast<JobState>(state), static_cast<JobEvent>(event)));
  for (int state = 0; state < kSessionStates; ++state)
    for (int event = 0; event < kSessionEvents; ++event)
      static_cast<void>(next(static_cast<SessionState>(state), static_cast<SessionEvent>(event)));
  return true;
}());

}  // namespace irsig
