#pragma once

namespace irsig {

// From here on SIGINT and SIGTERM do not end this process: interrupted() says that one came.
// SIGPIPE is ignored.
void hear_interruptions();
[[nodiscard]] bool interrupted();

}  // namespace irsig
