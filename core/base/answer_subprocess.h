#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"

namespace irsig {

// The main of a program that run_subprocess starts: sets the limits of a process for so many bytes
// of input (run_subprocess.h), reads them from standard input and writes what `reply_to` makes of
// them to standard output. `refusal` makes a reply of an error: here of memory that was not to be
// had. Does not return: no destructor of a library's globals runs after the reply is complete.
[[noreturn]] void answer_subprocess(std::uint64_t bytes,
                                    const std::function<std::string(std::string)>& reply_to,
                                    const std::function<std::string(const absl::Status&)>& refusal);

}  // namespace irsig
