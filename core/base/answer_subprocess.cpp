#include "core/base/answer_subprocess.h"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <new>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "core/base/run_subprocess.h"

#if defined(IRSIG_SANITIZED)
// They reserve terabytes of addresses: a limit of those would end the program at once.
constexpr bool kLimitAddresses = false;
#else
constexpr bool kLimitAddresses = true;
#endif

namespace irsig {
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
bool limit_all(const ApartLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  close_range(3, ~0U, 0);  // what another thread of the parent had open for a moment
  alarm(static_cast<unsigned>(limits.wall_s));
  // At the hard limit of processor time the kernel sends SIGKILL, as others do; before it, SIGXCPU.
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

bool write_all(int to, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = write(to, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

std::string answer(std::uint64_t bytes, const ApartLimits& limits,
                   const std::function<std::string(std::string)>& reply_to,
                   const std::function<std::string(const absl::Status&)>& refusal) {
  try {
    std::string file(bytes, '\0');
    if (!read_all(file)) return "";
    return reply_to(std::move(file));
  } catch (const std::bad_alloc&) {
    return refusal(absl::InvalidArgumentError(absl::StrCat(
        "importing its ", bytes, " bytes takes more than ", limits.memory_bytes / 1'000'000,
        " MB of memory: the file is damaged, or made to do harm")));
  }
}

}  // namespace

void answer_subprocess(std::uint64_t bytes, const std::function<std::string(std::string)>& reply_to,
                       const std::function<std::string(const absl::Status&)>& refusal) {
  const ApartLimits limits = apart_limits(bytes);
  if (!limit_all(limits)) _exit(1);
  // Libraries print warnings on standard output (OpenVDB, of a file of a newer version).
  const int to = dup(STDOUT_FILENO);
  if (to < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) _exit(1);
  const std::string reply = answer(bytes, limits, reply_to, refusal);
  _exit(!reply.empty() && write_all(to, reply) ? 0 : 1);
}

}  // namespace irsig
