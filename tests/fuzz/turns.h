#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace irsig::fuzz {

// How often a fuzz test tries something new: `for (Turns turn(300); turn.next();)`. As a rule the
// same few hundred times in every run. IRSIG_FUZZ_RUNS=20: twenty times as many. IRSIG_FUZZ_S=600:
// until 600 s are over, for each test of a program, and it says how often that was.
class Turns {
 public:
  // usual: how many as a rule. share: the part of the test's seconds that this loop of it gets.
  explicit Turns(int usual, double share = 1) : most_(usual) {
    if (const char* factor = std::getenv("IRSIG_FUZZ_RUNS")) most_ *= std::atoi(factor);
    if (const char* seconds = std::getenv("IRSIG_FUZZ_S")) seconds_ = share * std::atof(seconds);
  }
  ~Turns() {
    if (seconds_ > 0) std::printf("%d turns\n", done());
  }
  Turns(const Turns&) = delete;
  Turns& operator=(const Turns&) = delete;

  bool next() {
    ++index_;
    return index_ < most_ ||
           (seconds_ > 0 && std::chrono::steady_clock::now() - begun_ < Seconds(seconds_));
  }
  // Returns the index of the turn under way, from 0.
  int index() const { return index_; }
  int done() const { return index_; }

 private:
  using Seconds = std::chrono::duration<double>;
  int most_, index_ = -1;
  double seconds_ = 0;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace irsig::fuzz
