#include "coordinator/session.h"

namespace irsig {
namespace {

using S = SessionState;
using E = SessionEvent;
using A = SessionAction;

SessionStep next_of_idle(E event) {
  switch (event) {
    case E::kAskForJob:
      return {S::kIdle, A::kLease};
    case E::kHeartbeat:
      return {S::kIdle, A::kNone};
    case E::kForeignHeartbeat:
      return {S::kIdle, A::kAnswerInvalid};
    case E::kReturn:
    case E::kForeignReturn:
      return {S::kIdle, A::kRefuse};
    case E::kSilence:
    case E::kSuccessor:
      return {S::kLost, A::kNone};
  }
  return {S::kLost, A::kRefuse};
}

SessionStep next_of_computing(E event) {
  switch (event) {
    case E::kAskForJob:
      return {S::kIdle, A::kReleaseThenLease};
    case E::kHeartbeat:
      return {S::kComputing, A::kNone};
    case E::kForeignHeartbeat:
      return {S::kComputing, A::kAnswerInvalid};
    case E::kReturn:
      return {S::kIdle, A::kSettle};
    case E::kForeignReturn:
      return {S::kComputing, A::kRefuse};
    case E::kSilence:
    case E::kSuccessor:
      return {S::kLost, A::kRelease};
  }
  return {S::kLost, A::kRefuse};
}

}  // namespace

SessionStep next(SessionState state, SessionEvent event) {
  switch (state) {
    case S::kIdle:
      return next_of_idle(event);
    case S::kComputing:
      return next_of_computing(event);
    case S::kLost:
      break;
  }
  return {S::kLost, A::kRefuse};
}

}  // namespace irsig
