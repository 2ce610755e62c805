// irsig-import: reads one mesh file with Assimp, for a process that must not crash with it.
//
// usage: irsig-import FORM BYTES < file > reply     (core/scene/import_apart.h starts it)
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <new>
#include <string>
#include <system_error>

#include "core/scene/import_apart.h"
#include "core/scene/import_reply.h"
#include "core/scene/importer/import_float32.h"
#include "fmt/format.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// They reserve terabytes of addresses: a limit of those would end the program at once.
constexpr bool kLimitAddresses = false;
#else
constexpr bool kLimitAddresses = true;
#endif

#if defined(__SANITIZE_ADDRESS__)
// In its place. What Assimp leaks at its errors is the kernel's to take back.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:max_allocation_size_mb=1024:hard_rss_limit_mb=4096";
}
#endif

namespace {

// No more than whoever started irsig allows (ulimit).
bool limit(__rlimit_resource what, std::uint64_t value, std::uint64_t hard) {
  rlimit both{};
  if (getrlimit(what, &both) != 0) return false;
  both.rlim_max = std::min<rlim_t>(both.rlim_max, hard);
  both.rlim_cur = std::min<rlim_t>(both.rlim_max, value);
  return setrlimit(what, &both) == 0;
}
bool limit(__rlimit_resource what, std::uint64_t value) { return limit(what, value, value); }

// The kernel keeps them, whatever the library does to this process.
bool limit_all(const irsig::ImportLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  close_range(3, ~0U, 0);  // what another thread of the parent had open for a moment
  alarm(static_cast<unsigned>(limits.wall_s));
  // At the hard limit of the processor the kernel sends SIGKILL, as others do: before it, SIGXCPU.
  return (!kLimitAddresses || limit(RLIMIT_AS, limits.memory_bytes)) &&
         limit(RLIMIT_CPU, limits.cpu_s, limits.cpu_s + 5) && limit(RLIMIT_CORE, 0) &&
         limit(RLIMIT_FSIZE, 0);
}

bool read_all(std::string& out) {
  for (std::size_t had = 0; had < out.size();) {
    const ssize_t got = read(STDIN_FILENO, out.data() + had, out.size() - had);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    had += static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

std::string reply_to(std::uint64_t bytes, const std::string& form,
                     const irsig::ImportLimits& limits) {
  try {
    std::string file(bytes, '\0');
    if (!read_all(file)) return "";
    return irsig::encode_reply(irsig::import_float32(file, form));
  } catch (const std::bad_alloc&) {
    return irsig::encode_reply(absl::InvalidArgumentError(
        fmt::format("importing its {} bytes takes more than {} MB of memory: the file is damaged, "
                    "or made to do harm",
                    bytes, limits.memory_bytes / 1'000'000)));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t bytes = 0;
  const std::string form = argc == 3 ? argv[1] : "", count = argc == 3 ? argv[2] : "";
  if (std::from_chars(count.data(), count.data() + count.size(), bytes).ec != std::errc()) {
    std::fputs("irsig-import: started by irsig and irsig-worker, not by hand\n", stderr);
    return 2;
  }
  const irsig::ImportLimits limits = irsig::import_limits(bytes);
  if (!limit_all(limits)) return 1;
  const std::string reply = reply_to(bytes, form, limits);
  // No destructors of the library's globals after this: the reply is complete.
  _exit(!reply.empty() && write_all(reply) ? 0 : 1);
}
