// Loaded into a process before its libraries (LD_PRELOAD): the process is killed, as by kill -9,
// before or after its n-th call of a kind.
//
//   IRSIG_TEST_DIE_AT    KIND:N, KIND one of sync (fsync, fdatasync), write (pwrite, write into
//                        files, ftruncate, unlink, rename) and send (sendmsg), N from 1; an
//                        "after" behind it: when the call has returned. "sync:3", "send:7:after"
//   IRSIG_TEST_CALLS     a file that gets the numbers of calls: sync, write, send, as three
//                        64-bit numbers that count while the process runs
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

enum Kind { kSync, kWrite, kSend, kKinds };
constexpr const char* kNames[kKinds] = {"sync", "write", "send"};

struct Plan {
  int kind = -1;
  std::uint64_t at = 0;
  bool after = false;
  std::atomic<std::uint64_t>* calls = nullptr;

  Plan() {
    if (const char* file = std::getenv("IRSIG_TEST_CALLS")) {
      const int fd = open(file, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
      void* shared = MAP_FAILED;
      if (fd >= 0 && posix_fallocate(fd, 0, sizeof(*calls) * kKinds) == 0)
        shared = mmap(nullptr, sizeof(*calls) * kKinds, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
      if (shared == MAP_FAILED) _exit(99);
      calls = static_cast<std::atomic<std::uint64_t>*>(shared);
    }
    const char* text = std::getenv("IRSIG_TEST_DIE_AT");
    if (text == nullptr) return;
    for (int k = 0; k < kKinds; ++k) {
      const std::size_t length = std::strlen(kNames[k]);
      if (std::strncmp(text, kNames[k], length) != 0 || text[length] != ':') continue;
      char* end = nullptr;
      kind = k;
      at = std::strtoull(text + length + 1, &end, 10);
      after = std::strcmp(end, ":after") == 0;
      if (at == 0 || (*end != '\0' && !after)) kind = -1;
    }
    if (kind < 0) _exit(99);
  }
};

Plan& plan() {
  static Plan the_plan;
  return the_plan;
}

std::atomic<std::uint64_t> own_calls[kKinds];

// Counts one call; kills the process if this is the one.
class Call {
 public:
  explicit Call(Kind kind) {
    Plan& p = plan();
    const std::uint64_t number = (p.calls != nullptr ? p.calls : own_calls)[kind].fetch_add(1) + 1;
    fatal_ = p.kind == kind && p.at == number;
    if (fatal_ && !p.after) die();
  }
  ~Call() {
    if (fatal_) die();
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

 private:
  static void die() {
    kill(getpid(), SIGKILL);
    for (;;) pause();
  }
  bool fatal_ = false;
};

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool is_file(int fd) {
  struct stat info {};
  return fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
}

}  // namespace

extern "C" {

int fsync(int fd) {
  static auto* const real = next<int(int)>("fsync");
  const Call call(kSync);
  return real(fd);
}
int fdatasync(int fd) {
  static auto* const real = next<int(int)>("fdatasync");
  const Call call(kSync);
  return real(fd);
}
ssize_t pwrite(int fd, const void* bytes, size_t count, off_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  const Call call(kWrite);
  return real(fd, bytes, count, at);
}
ssize_t pwrite64(int fd, const void* bytes, size_t count, off64_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64");
  const Call call(kWrite);
  return real(fd, bytes, count, at);
}
ssize_t write(int fd, const void* bytes, size_t count) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  if (fd <= STDERR_FILENO || !is_file(fd)) return real(fd, bytes, count);
  const Call call(kWrite);
  return real(fd, bytes, count);
}
int ftruncate(int fd, off_t length) noexcept {
  static auto* const real = next<int(int, off_t)>("ftruncate");
  const Call call(kWrite);
  return real(fd, length);
}
int ftruncate64(int fd, off64_t length) noexcept {
  static auto* const real = next<int(int, off64_t)>("ftruncate64");
  const Call call(kWrite);
  return real(fd, length);
}
int unlink(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("unlink");
  const Call call(kWrite);
  return real(path);
}
int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  const Call call(kWrite);
  return real(from, to);
}
ssize_t sendmsg(int fd, const msghdr* message, int flags) {
  static auto* const real = next<ssize_t(int, const msghdr*, int)>("sendmsg");
  const Call call(kSend);
  return real(fd, message, flags);
}

}  // extern "C"
