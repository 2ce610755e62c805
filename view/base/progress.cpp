#include "view/base/progress.h"

#include <unistd.h>

#include <condition_variable>
#include <mutex>

#include "core/base/printable.h"
#include "view/base/print.h"

namespace irsig {
namespace {

using Steady = std::chrono::steady_clock;
using namespace std::chrono_literals;

bool on_terminal() { return isatty(STDERR_FILENO) == 1; }

}  // namespace

void ProgressLine::show(const std::string& text) {
  if (on_terminal()) {
    fmt::print(stderr, "\r{}\x1b[K", one_line(text));
  } else if (!shown_ || Steady::now() - at_ >= 5s) {
    print_note("{}\n", text);
    at_ = Steady::now();
  }
  shown_ = true;
}

ProgressLine::~ProgressLine() {
  if (shown_ && on_terminal()) print_note("\n");
}

void ProgressLine::clear() {
  if (shown_ && on_terminal()) fmt::print(stderr, "\r\x1b[K");
  shown_ = false;
}

WaitProgress::WaitProgress(std::string what)
    : thread_([what = std::move(what), start = Steady::now()](const std::stop_token& stop) {
        std::mutex mutex;
        std::condition_variable_any ended;
        ProgressLine line;
        for (auto pause = 1800ms;; pause = 500ms) {
          std::unique_lock lock(mutex);
          if (ended.wait_for(lock, stop, pause, [] { return false; }) || stop.stop_requested())
            return line.clear();
          line.show(fmt::format("{}: {:.0f} s", what,
                                std::chrono::duration<double>(Steady::now() - start).count()));
        }
      }) {}

LoopProgress::LoopProgress(std::string what, std::size_t total)
    : what_(std::move(what)), total_(total), start_(Steady::now()), shown_(start_ + 1800ms) {}

void LoopProgress::step(std::size_t by) {
  done_ += by;
  const auto now = Steady::now();
  if (now - shown_ < 200ms) return;
  shown_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  line_.show(
      fmt::format("{}: {} of {}, {:.0f} s left", what_, done_, total_,
                  seconds / static_cast<double>(done_) * static_cast<double>(total_ - done_)));
}

}  // namespace irsig
