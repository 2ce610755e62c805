#pragma once

namespace irsig {

// Makes SIGINT and SIGTERM set interrupted() from here on instead of ending this process. SIGPIPE
// is ignored.
void hear_interruptions();
[[nodiscard]] bool interrupted();

}  // namespace irsig
