// A farm of many machines, simulated: a real coordinator process over mutual TLS on loopback, and
// workers that do no physics, each with its own connection, session and heartbeats (the real lease
// loop), in two processes. Jobs take --job-s on average, between half and one and a half of it;
// their results are real in size. Prints a table; --require: exit code 1 where what is asked is not
// met. Without it only what must hold on any machine counts: every job done, none given up.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "coordinator/client/authority.h"
#include "coordinator/client/child_process.h"
#include "coordinator/client/farm_client.h"
#include "jobs/keys/expand.h"
#include "tests/fault/synthetic_farm.h"

namespace {

using namespace irsig;
using Clock = std::chrono::steady_clock;

std::string coordinator_executable = IRSIG_COORDINATOR;
constexpr double kPatience_s = 600;
constexpr rlim_t kOpenFiles = 4096;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "farm_scale_bench: %s\n", what.c_str());
  std::exit(1);
}

void until(const std::string& what, const std::function<bool()>& fact, int pause_ms = 20) {
  for (const auto start = Clock::now(); !fact();) {
    if (seconds_since(start) > kPatience_s)
      fail(absl::StrCat("not within ", kPatience_s, " s: ", what));
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
  }
}

// State of the workers of a process, in a file that both processes have in memory.
struct Board {
  std::atomic<std::int64_t> computing, computed, begun;  // workers, jobs, workers with a first job
};

Board& board_in(const std::string& path) {
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0 || ftruncate(fd, sizeof(Board)) != 0) fail("no board at " + path);
  void* shared = mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  if (shared == MAP_FAILED) fail("no board at " + path);
  return *static_cast<Board*>(shared);
}

struct CrewPlan {
  std::string name, coordinator, tls, board;
  int workers = 0;
  double job_s = 0;
};

// One result, made once for all of them: what happens between lease and completion is not measured.
class TimedRunner final : public JobRunner {
 public:
  TimedRunner(const schema::JobResult& result, double job_s, Board& board)
      : result_(result), job_s_(job_s), board_(board) {}
  absl::StatusOr<schema::JobResult> run(const schema::JobSpec& job) const override {
    if (!begun_) ++board_.begun;
    begun_ = true;
    ++board_.computing;
    const double share =
        static_cast<double>(std::strtoull(job.job_key().substr(0, 8).c_str(), nullptr, 16)) /
        0x1p32;
    std::this_thread::sleep_for(std::chrono::duration<double>(job_s_ * (0.5 + share)));
    --board_.computing;
    ++board_.computed;
    schema::JobResult out = result_;
    out.set_job_key(job.job_key());
    return out;
  }

 private:
  const schema::JobResult& result_;
  double job_s_;
  Board& board_;
  mutable std::atomic<bool> begun_ = false;
};

TlsFiles files(const std::string& folder, const std::string& who) {
  return {absl::StrCat(folder, "/", who, ".pem"), absl::StrCat(folder, "/", who, ".key"),
          folder + "/ca.pem"};
}

Address address_of(const std::string& text, const std::string& tls, const std::string& who) {
  auto address = parse_address(text, {.tls = files(tls, who)});
  if (!address.ok()) fail(std::string(address.status().message()));
  return *std::move(address);
}

std::atomic<bool> stop_asked = false;

int work(const CrewPlan& crew) {
  std::signal(SIGTERM, [](int) { stop_asked = true; });
  Board& board = board_in(crew.board);
  const auto sweep = frigate_sweep(1);
  const schema::JobResult result = synthetic_result(sweep, expand_jobs(sweep, 1).front());
  const RunnerFactory factory =
      [&](const schema::ResolvedSweep&, const Assets&,
          const HeatOutputs&) -> absl::StatusOr<std::unique_ptr<JobRunner>> {
    return std::make_unique<TimedRunner>(result, crew.job_s, board);
  };
  const Address address = address_of(crew.coordinator, crew.tls, "worker");
  std::vector<std::thread> threads;
  std::atomic<int> failed = 0;
  for (int i = 0; i < crew.workers; ++i) {
    threads.emplace_back([&, i] {
      WorkerPlan plan;
      plan.coordinator = address;
      plan.worker_name = absl::StrCat(crew.name, "-", i);
      plan.determinism_class = kSyntheticClass;
      plan.physics_version = 1;
      plan.give_up_after_s = kPatience_s;
      if (const auto status = run_lease_loop(plan, factory, stop_asked); !status.ok()) {
        ++failed;
        std::fprintf(stderr, "%s\n", status.ToString().c_str());
      }
    });
  }
  for (auto& thread : threads) thread.join();
  return failed == 0 ? 0 : 1;
}

// A coordinator of its own database, and how it is reached.
class Coordinator {
 public:
  Coordinator(std::string folder, std::string name, double lost_after_s)
      : folder_(std::move(folder)), name_(std::move(name)), lost_after_s_(lost_after_s) {
    start();
  }
  // The port, once the first one has it, stays.
  void start() {
    until("a coordinator listens", [this] {
      const std::string log = absl::StrCat(folder_, "/", name_, "-", ++starts_, ".log");
      const TlsFiles tls = files(folder_ + "/tls", "coordinator");
      auto child = ChildProcess::start(
          {coordinator_executable, "--db", database(), "--listen", listen_, "--audit-share", "0",
           "--heartbeat-s", std::to_string(lost_after_s_ / 5), "--lost-after-s",
           std::to_string(lost_after_s_), "--tls-cert", tls.certificate, "--tls-key", tls.key,
           "--tls-ca", tls.ca},
          log, SIGKILL);
      if (!child.ok()) fail(std::string(child.status().message()));
      process_ = *std::move(child);
      while (!process_->ended()) {
        std::ifstream in(log);
        for (std::string line; std::getline(in, line);) {
          constexpr std::string_view kListening = "irsig-coordinator: listening on ";
          if (!line.starts_with(kListening) || in.eof()) continue;
          listen_ = line.substr(kListening.size());
          return true;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      return false;
    });
  }
  void kill() {
    peak_bytes_ = peak_bytes();
    cpu_before_s_ = cpu_s();
    process_->signal(SIGKILL);
    process_->wait(60);
  }
  void end() {
    process_->signal(SIGTERM);
    if (!process_->wait(120) || !process_->succeeded()) fail(process_->last_words());
  }
  [[nodiscard]] Address address() const { return address_of(listen_, folder_ + "/tls", "user"); }
  [[nodiscard]] std::string listens_on() const { return listen_; }
  [[nodiscard]] std::string database() const { return absl::StrCat(folder_, "/", name_, ".sigdb"); }

  // Returns the CPU time of all coordinators that have served this database.
  [[nodiscard]] double cpu_s() const {
    std::ifstream in(absl::StrCat("/proc/", process_->pid(), "/stat"));
    std::string text;
    std::getline(in, text);
    double user = 0, system = 0;
    if (std::sscanf(text.c_str() + text.rfind(')') + 2,
                    "%*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lf %lf", &user, &system) != 2)
      fail("no times of the coordinator");
    return cpu_before_s_ + (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }
  [[nodiscard]] double peak_bytes() const {
    std::ifstream in(absl::StrCat("/proc/", process_->pid(), "/status"));
    for (std::string line; std::getline(in, line);)
      if (line.starts_with("VmHWM:"))
        return std::max(peak_bytes_, 1024 * std::strtod(line.c_str() + 6, nullptr));
    return peak_bytes_;
  }
  // Its first sweep; nothing while it does not answer.
  [[nodiscard]] std::optional<schema::SweepStatus> sweep() const {
    const auto told = farm_status(address(), 10);
    if (!told.ok() || told->sweep_size() != 1) return std::nullopt;
    return told->sweep(0);
  }
  [[nodiscard]] int workers() const {
    const auto told = farm_status(address(), 10);
    return told.ok() ? told->worker_size() : -1;
  }

 private:
  std::string folder_, name_, listen_ = "127.0.0.1:0";
  double lost_after_s_;
  int starts_ = 0;
  double cpu_before_s_ = 0, peak_bytes_ = 0;
  std::optional<ChildProcess> process_;
};

class Crew {
 public:
  Crew(const std::string& folder, const Coordinator& to, const std::string& name, int workers,
       double job_s)
      : board_(board_in(absl::StrCat(folder, "/", name, ".board"))) {
    auto child =
        ChildProcess::start({std::filesystem::read_symlink("/proc/self/exe").string(), "--crew",
                             name, "--workers", std::to_string(workers), "--job-s",
                             std::to_string(job_s), "--coordinator", to.listens_on(), "--tls",
                             folder + "/tls", "--board", absl::StrCat(folder, "/", name, ".board")},
                            absl::StrCat(folder, "/", name, ".log"), SIGKILL);
    if (!child.ok()) fail(std::string(child.status().message()));
    process_ = *std::move(child);
  }
  void signal(int number) { process_->signal(number); }
  void end() {
    process_->signal(SIGTERM);
    if (!process_->wait(120) || !process_->succeeded()) fail(process_->last_words());
  }
  void check() {
    if (process_->ended()) fail(process_->last_words());
  }
  [[nodiscard]] const Board& board() const { return board_; }

 private:
  Board& board_;
  std::optional<ChildProcess> process_;
};

// The table.
class Table {
 public:
  Table() { std::printf("%-58s %12s  %s\n", "measured", "", "asked"); }
  void line(const std::string& what, double value, const char* unit) {
    std::printf("%-58s %8.4g %-4s\n", what.c_str(), value, unit);
    std::fflush(stdout);
  }
  void asked(const std::string& what, double value, const char* unit, double bound, bool at_least) {
    const bool met = at_least ? value >= bound : value <= bound;
    all_met_ = all_met_ && met;
    std::printf("%-58s %8.4g %-4s %s %g%s\n", what.c_str(), value, unit,
                at_least ? ">=" : "<=", bound, met ? "" : "   MISSED");
    std::fflush(stdout);
  }
  [[nodiscard]] bool all_met() const { return all_met_; }

 private:
  bool all_met_ = true;
};

struct Options {
  int workers = 1000, throughput_workers = 64, throughput_jobs = 3000;
  double job_s = 10, steady_s = 30, lost_after_s = 10;
  std::string folder = ".";
};

void measure_farm(const Options& o, const std::string& folder, Table& table) {
  Coordinator coordinator(folder, "farm", o.lost_after_s);
  // Enough for all that follows.
  const auto jobs = static_cast<std::uint32_t>(
      o.workers * (o.steady_s + 7 * o.job_s + 2 * o.lost_after_s + 10) / o.job_s);
  if (auto sent = submit(coordinator.address(), frigate_sweep(jobs), {}, 1); !sent.ok())
    fail(std::string(sent.status().message()));

  const int vanishing = o.workers * 3 / 10, staying = o.workers - vanishing;
  auto start = Clock::now();
  double cpu_s = coordinator.cpu_s();
  Crew stay(folder, coordinator, "stay", staying, o.job_s);
  Crew vanish(folder, coordinator, "vanish", vanishing, o.job_s);
  const auto begun = [&] { return stay.board().begun + vanish.board().begun; };
  const auto computing = [&] { return stay.board().computing + vanish.board().computing; };
  until(
      "every worker has a job",
      [&] {
        stay.check();
        vanish.check();
        return begun() == o.workers;
      },
      5);
  table.line(absl::StrCat("time until ", o.workers, " workers that start at once compute"),
             seconds_since(start), "s");
  table.line("  the coordinator's CPU in it", coordinator.cpu_s() - cpu_s, "s");
  table.line("  its peak memory so far", coordinator.peak_bytes() / 1e6, "MB");

  // Each of them has computed a job or two: they are no longer in step.
  std::this_thread::sleep_for(std::chrono::duration<double>(1.5 * o.job_s));
  start = Clock::now();
  cpu_s = coordinator.cpu_s();
  double busy = 0;
  int samples = 0;
  for (; seconds_since(start) < o.steady_s; ++samples) {
    busy += static_cast<double>(computing()) / o.workers;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  table.asked("share of time in which workers compute", 100 * busy / samples, "%", 98, true);
  table.asked("the coordinator's CPU meanwhile",
              (coordinator.cpu_s() - cpu_s) / seconds_since(start), "core", 1, false);

  // The workers vanish without a word: the connections stay open.
  vanish.signal(SIGSTOP);
  start = Clock::now();
  until(
      "those who vanished are lost", [&] { return coordinator.workers() == staying; }, 250);
  table.line(absl::StrCat("time until ", vanishing, " that fall silent at once are lost"),
             seconds_since(start), "s");
  const auto leased = coordinator.sweep();
  if (leased && leased->leased() > static_cast<std::uint64_t>(staying))
    fail("jobs of lost workers are still leased");
  vanish.signal(SIGCONT);
  start = Clock::now();
  until(
      "they are back", [&] { return coordinator.workers() == o.workers; }, 250);
  table.line("time until they are back", seconds_since(start), "s");
  std::this_thread::sleep_for(std::chrono::duration<double>(o.job_s));

  table.line("  the coordinator's peak memory so far", coordinator.peak_bytes() / 1e6, "MB");

  start = Clock::now();
  cpu_s = coordinator.cpu_s();
  coordinator.kill();
  coordinator.start();
  const double restarted_s = seconds_since(start);
  double recovered_s = 0, worst = 1;
  bool all_are_back = false;
  auto asked = start;
  while (seconds_since(start) < std::max(2 * o.job_s, o.lost_after_s) || !all_are_back) {
    const double share = static_cast<double>(computing()) / o.workers;
    if (share < 0.95) recovered_s = seconds_since(start);
    worst = std::min(worst, share);
    // Questions are rare enough to be no work for the coordinator.
    const bool asks = !all_are_back && seconds_since(asked) > 0.5;
    if (asks) asked = Clock::now();
    if (asks && coordinator.workers() == o.workers) {
      all_are_back = true;
      table.line("coordinator killed: time until all workers are back", seconds_since(start), "s");
    }
    if (seconds_since(start) > kPatience_s) fail("not all workers came back");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  table.line("  until another one listens", restarted_s, "s");
  table.asked("  last moment with less than 95 % computing", recovered_s, "s", 10, false);
  table.line("  fewest that computed", 100 * worst, "%");
  table.line("  the coordinators' CPU since then", coordinator.cpu_s() - cpu_s, "s");

  until(
      "all is done",
      [&] {
        const auto now = coordinator.sweep();
        if (now && now->quarantined() > 0) fail("jobs were given up");
        return now && now->done() == jobs;
      },
      200);
  const auto computed = stay.board().computed + vanish.board().computed;
  table.line("jobs", jobs, "");
  table.line("  computed twice or more", static_cast<double>(computed) - jobs, "");
  table.asked("the coordinator's peak memory", coordinator.peak_bytes() / 1e6, "MB", 500, false);
  stay.end();
  vanish.end();
  coordinator.end();
}

void measure_writer(const Options& o, const std::string& folder, Table& table) {
  Coordinator coordinator(folder, "writer", o.lost_after_s);
  Crew crew(folder, coordinator, "writer", o.throughput_workers, 0);
  until("workers wait", [&] { return coordinator.workers() == o.throughput_workers; });
  const auto sweep = frigate_sweep(static_cast<std::uint32_t>(o.throughput_jobs));
  const auto one = synthetic_result(sweep, expand_jobs(sweep, 1).front());
  const double cpu_s = coordinator.cpu_s();
  if (auto sent = submit(coordinator.address(), sweep, {}, 1); !sent.ok())
    fail(std::string(sent.status().message()));
  const auto start = Clock::now();
  until("all is done", [&] {
    const auto now = coordinator.sweep();
    return now && now->done() == static_cast<std::uint64_t>(o.throughput_jobs);
  });
  const double elapsed_s = seconds_since(start);
  const double rows = static_cast<double>(o.throughput_jobs) * one.view().row_size();
  table.asked(absl::StrCat("rows with spectra and thumbnails, ", o.throughput_workers, " workers"),
              rows / elapsed_s, "/s", 5000, true);
  table.line("  of bytes each", static_cast<double>(one.ByteSizeLong()) / one.view().row_size(),
             "");
  table.line("  the coordinator's CPU for 1000", 1000 * (coordinator.cpu_s() - cpu_s) / rows, "s");
  crew.end();
  coordinator.end();
}

int measure(const Options& o, bool require) {
  std::string folder = std::filesystem::absolute(o.folder).string() + "/farm-scale-XXXXXX";
  if (mkdtemp(folder.data()) == nullptr) fail("cannot write into " + o.folder);
  const double now_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  const std::string tls = folder + "/tls";
  if (auto s = make_authority(tls, "farm", now_s, 86400); !s.ok()) fail(std::string(s.message()));
  for (const CertificateWish& wish : {CertificateWish{"coordinator", {"127.0.0.1"}, {}},
                                      CertificateWish{"worker", {}, {Role::kWork}},
                                      CertificateWish{"user", {}, {Role::kSubmit, Role::kRead}}})
    if (auto s = issue_certificate(tls, wish, tls, now_s, 80000); !s.ok())
      fail(std::string(s.message()));
  double load[1] = {};
  getloadavg(load, 1);
  Table table;
  table.line("load of the machine before", load[0], "");
  measure_farm(o, folder, table);
  measure_writer(o, folder, table);
  std::filesystem::remove_all(folder);
  return table.all_met() || !require ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"a farm of many machines, simulated on one"};
  Options o;
  CrewPlan crew;
  bool require = false;
  app.add_option("--workers", o.workers)->capture_default_str()->check(CLI::Range(1, 3000));
  app.add_option("--job-s", o.job_s, "of a job, on average")->capture_default_str();
  app.add_option("--steady-s", o.steady_s, "for which shares are measured")->capture_default_str();
  app.add_option("--lost-after-s", o.lost_after_s, "of silence")->capture_default_str();
  app.add_option("--throughput-workers", o.throughput_workers)->capture_default_str();
  app.add_option("--throughput-jobs", o.throughput_jobs)->capture_default_str();
  app.add_option("--folder", o.folder, "where databases are written")->capture_default_str();
  app.add_option("--coordinator-executable", coordinator_executable)->capture_default_str();
  app.add_flag("--require", require, "exit code 1 where what is asked is not met");
  // Options of the processes that it starts:
  app.add_option("--crew", crew.name)->group("");
  app.add_option("--coordinator", crew.coordinator)->group("");
  app.add_option("--tls", crew.tls)->group("");
  app.add_option("--board", crew.board)->group("");
  CLI11_PARSE(app, argc, argv);
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = std::min(files.rlim_max, std::max(files.rlim_cur, kOpenFiles));
  setrlimit(RLIMIT_NOFILE, &files);
  if (crew.name.empty()) return measure(o, require);
  crew.workers = o.workers;
  crew.job_s = o.job_s;
  return work(crew);
}
