// irsig-coordinator: hands out the jobs of a database's sweeps and stores their results.
#include <google/protobuf/stubs/logging.h>
#include <malloc.h>
#include <semaphore.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>

#include "coordinator/client/address.h"
#include "coordinator/client/farm_log.h"
#include "coordinator/farm_server.h"
#include "coordinator/front_gate.h"
#include "core/base/printable.h"
#include "core/base/standard_output.h"
#include "jobs/check_resolved.h"

namespace {

sem_t end_asked;  // by a signal or by a failure of the store

void ask_to_end(int) { sem_post(&end_asked); }

template <class SomeClock>
double seconds() {
  return std::chrono::duration<double>(SomeClock::now().time_since_epoch()).count();
}

// 2: what was given is wrong; 1: anything else, a port in use among it (the input is right, the
// moment is wrong).
int report(const absl::Status& status) {
  const std::string what = irsig::printable(std::string(status.message()));
  std::fprintf(stderr, "irsig-coordinator: %s\n", what.c_str());
  return absl::IsInvalidArgument(status) || absl::IsNotFound(status) || absl::IsOutOfRange(status)
             ? 2
             : 1;
}

// A thousand connections come to 400 MB with it, 580 MB without: what came of a result goes back to
// the system as soon as that is stored, instead of staying where something small lies behind it, in
// one of two pools and not in one of each thread. It costs a fifth of the rows that can be stored
// in a second.
void keep_memory_flat() {
  mallopt(M_ARENA_MAX, 2);
  mallopt(M_MMAP_THRESHOLD, 64 << 10);
}

}  // namespace

int main(int argc, char** argv) {
  keep_memory_flat();
  // protobuf writes a line to standard error for each text that is not UTF-8: a client that sends
  // many of them would flood it.
  google::protobuf::SetLogHandler(nullptr);
  CLI::App app{"hands out the jobs of a signature database to workers and stores their results"};
  std::string db_path, listen, tls_crl;
  bool remove_unused = false;
  irsig::NetworkOptions network;
  irsig::FarmRules rules;
  irsig::LogOptions log;
  app.add_option("--db", db_path, "the database; made if it does not exist")->required();
  app.add_option(
      "--listen", listen,
      "unix:PATH (mode 0600) or HOST:PORT (0: any free port); without it unix:FILE-farm, "
      "beside the database");
  irsig::add_network_options(app, network);
  app.add_option(
      "--tls-crl", tls_crl,
      "PEM file: certificates that the authority has revoked; read anew when it changes");
  app.add_option("--heartbeat-s", rules.heartbeat_s, "how often workers report")
      ->capture_default_str()
      ->check(CLI::Range(0.05, 3600.0));
  app.add_option("--lost-after-s", rules.lost_after_s, "silence after which a worker is lost")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 86400.0));
  app.add_option("--audit-share", rules.audit_fraction,
                 "of jobs that a second worker computes, too, so that their bits can be compared")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--remove-unused", remove_unused,
               "a database that it made and nobody used is removed at the end");
  irsig::add_log_options(app, log);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error) != 0) return 2;
    const absl::Status printed = irsig::end_standard_output();
    return printed.ok() ? 0 : report(printed);
  }
  // NaN passes the range checks of the options, because every comparison with NaN is false. The
  // comparisons below are negated so that NaN is refused.
  if (!(rules.lost_after_s >= 2 * rules.heartbeat_s))
    return report(
        absl::InvalidArgumentError("--lost-after-s must be at least twice --heartbeat-s"));
  if (!(rules.audit_fraction >= 0))
    return report(absl::InvalidArgumentError("--audit-share: expected a number from 0 to 1"));
  if (listen.empty()) listen = "unix:" + db_path + "-farm";
  const auto address = irsig::parse_address(listen, network);
  if (!address.ok()) return report(address.status());

  if (auto begun = irsig::start_log("coordinator", log); !begun.ok()) return report(begun);
  sem_init(&end_asked, 0, 0);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit (ulimit -f) is a full disk
  irsig::FrontGate::raise_open_files();

  std::mutex mutex;
  absl::Status failure;
  auto server =
      irsig::FarmServer::start({db_path, *address, rules, seconds<std::chrono::steady_clock>,
                                seconds<std::chrono::system_clock>,
                                [&](const absl::Status& status) {
                                  const std::lock_guard lock(mutex);
                                  failure = status;
                                  sem_post(&end_asked);
                                },
                                irsig::check_resolved, remove_unused, tls_crl});
  if (!server.ok()) return report(server.status());
  // Until here a signal ends it at once: what opening a database leaves half done is undone by the
  // next one who opens it.
  std::signal(SIGTERM, ask_to_end);
  std::signal(SIGINT, ask_to_end);
  std::printf("irsig-coordinator: listening on %s\n", (*server)->address().c_str());
  std::fflush(stdout);
  while (sem_wait(&end_asked) != 0) {
  }
  std::signal(SIGTERM, SIG_DFL);  // asked a second time, it ends as it is
  std::signal(SIGINT, SIG_DFL);
  const auto stopped = (*server)->stop();
  const std::lock_guard lock(mutex);
  if (!failure.ok()) return report(failure);
  if (absl::IsUnavailable(stopped)) {
    const std::string what = irsig::printable(std::string(stopped.message()));
    std::fprintf(stderr, "irsig-coordinator: warning: %s\n", what.c_str());
    return 0;
  }
  if (!stopped.ok()) return report(stopped);
  return 0;
}
