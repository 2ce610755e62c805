#pragma once

#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

// Early returns for functions that return absl::Status or absl::StatusOr. Each macro is several
// statements: it stands in a block of its own braces, never as the body of an `if` without them.

#define IRSIG_STATUS_JOIN_INNER(a, b) a##b
#define IRSIG_STATUS_JOIN(a, b) IRSIG_STATUS_JOIN_INNER(a, b)

// Returns the expression's status from the enclosing function unless the status is OK.
#define RETURN_IF_ERROR(...)                                             \
  do {                                                                   \
    if (absl::Status irsig_status = (__VA_ARGS__); !irsig_status.ok()) { \
      return irsig_status;                                               \
    }                                                                    \
  } while (false)

// Declares `lhs` and moves the value of the absl::StatusOr expression into it, or returns the
// expression's status from the enclosing function.
#define ASSIGN_OR_RETURN(lhs, ...) \
  IRSIG_ASSIGN_OR_RETURN(IRSIG_STATUS_JOIN(irsig_status_or_, __LINE__), lhs, (__VA_ARGS__))
#define IRSIG_ASSIGN_OR_RETURN(result, lhs, ...)       \
  auto result = __VA_ARGS__;                           \
  if (!result.ok()) return std::move(result).status(); \
  lhs = *std::move(result)
