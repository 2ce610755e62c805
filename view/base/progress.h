#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <thread>

namespace irsig {

// A line on standard error that is overwritten on a terminal; elsewhere a new line every few
// seconds.
class ProgressLine {
 public:
  ProgressLine() = default;
  ~ProgressLine();  // the last text stays
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const std::string& text);
  void clear();  // it was only of interest while it lasted

 private:
  bool shown_ = false;
  std::chrono::steady_clock::time_point at_{};
};

// Reports the progress of a loop that takes longer than two seconds: "rows written: 120 of 4000, 12
// s left".
class LoopProgress {
 public:
  LoopProgress(std::string what, std::size_t total);
  ~LoopProgress() { line_.clear(); }
  LoopProgress(const LoopProgress&) = delete;
  LoopProgress& operator=(const LoopProgress&) = delete;

  void step(std::size_t by = 1);

 private:
  std::string what_;
  std::size_t total_, done_ = 0;
  std::chrono::steady_clock::time_point start_, shown_;
  ProgressLine line_;
};

// Reports work of unknown length that takes longer than two seconds: "building the scene: 12 s". A
// separate thread prints the line until this object is destroyed.
class WaitProgress {
 public:
  explicit WaitProgress(std::string what);
  WaitProgress(const WaitProgress&) = delete;
  WaitProgress& operator=(const WaitProgress&) = delete;

 private:
  std::jthread thread_;
};

}  // namespace irsig
