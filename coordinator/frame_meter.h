#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <unordered_set>

#include "absl/status/status.h"

namespace irsig {

// A number of events that is allowed at once, and how many of them are forgotten in a second.
class LeakyBucket {
 public:
  LeakyBucket(double most, double per_s) : most_(most), per_s_(per_s) {}

  void add(double now_s);
  [[nodiscard]] bool is_over(double now_s);

 private:
  void leak(double now_s);

  const double most_, per_s_;
  double level_ = 0, leaked_at_s_ = 0;
};

// Limits of one connection, and of all together. The workers of a farm have three calls at once and
// cancel one of them when the coordinator does not answer.
struct FrameLimits {
  std::size_t most_streams = 32;  // that are open at once
  std::size_t few_streams = 8;    // ... once all connections together have most_streams_of_all
  std::size_t most_streams_of_all = 5000;
  double most_resets = 50, resets_per_s = 5;
  double most_resets_of_all = 5000, resets_of_all_per_s = 1000;
  // Limit of a call's headers: its path, and a few hundred bytes of metadata.
  std::uint32_t most_header_bytes = 16384;
  int most_header_frames = 8;
};

// Totals of all connections of a gate. Belongs to one thread.
struct FrameTotals {
  explicit FrameTotals(const FrameLimits& all) : limits(all) {}

  const FrameLimits limits;
  std::size_t streams = 0;
  LeakyBucket resets{limits.most_resets_of_all, limits.resets_of_all_per_s};
};

// Finds the frame headers in the bytes of one direction of a connection (RFC 9113, section 4.1).
class FrameScanner {
 public:
  struct Frame {
    std::uint32_t length;  // of the payload after the header [bytes]
    std::uint8_t type, flags;
    std::uint32_t stream;
  };

  explicit FrameScanner(std::size_t preface_bytes) : to_skip_(preface_bytes) {}

  // Finds the next frame whose header is complete, and removes the bytes read from `bytes`. Returns
  // false if there is no further complete header in `bytes`.
  [[nodiscard]] bool next(std::string_view& bytes, Frame& frame);

 private:
  static constexpr std::size_t kHeader = 9;
  std::size_t to_skip_;  // of the preface, or of a frame's payload
  unsigned char header_[kHeader] = {};
  std::size_t known_ = 0;
};

// Counts the work that the client of one connection causes in an HTTP/2 server beyond its answers:
// streams that are opened, or opened and reset at once (CVE-2023-44487), and header blocks that do
// not end (CVE-2023-33953, CVE-2024-27316). Reads frame headers only: no payload is read or kept.
// Belongs to one thread.
class FrameMeter {
 public:
  explicit FrameMeter(FrameTotals& totals) : totals_(totals) {}
  ~FrameMeter();
  FrameMeter(const FrameMeter&) = delete;
  FrameMeter& operator=(const FrameMeter&) = delete;

  // Counts the bytes of one direction. RESOURCE_EXHAUSTED: the client exceeded a limit, which the
  // message names; drop the bytes and close the connection.
  [[nodiscard]] absl::Status from_client(std::string_view bytes, double now_s);
  [[nodiscard]] absl::Status from_server(std::string_view bytes, double now_s);

 private:
  [[nodiscard]] absl::Status headers(const FrameScanner::Frame& frame);
  [[nodiscard]] absl::Status header_block(const FrameScanner::Frame& frame);
  [[nodiscard]] absl::Status reset(std::uint32_t stream, double now_s);
  void close(std::uint32_t stream);

  FrameTotals& totals_;
  FrameScanner client_{24};  // "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
  FrameScanner server_{0};
  std::unordered_set<std::uint32_t> open_;
  std::uint32_t last_stream_ = 0;
  std::uint64_t block_bytes_ = 0;
  int block_frames_ = 0;
  double seen_at_s_ = 0;
  LeakyBucket resets_{totals_.limits.most_resets, totals_.limits.resets_per_s};
};

}  // namespace irsig
