// Tests the work that a client of HTTP/2 may ask of its server (coordinator/frame_meter.h), frame
// by frame and in pieces of any size.
#include "coordinator/frame_meter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace irsig {
namespace {

using testing::HasSubstr;

constexpr std::uint8_t kData = 0, kHeaders = 1, kReset = 3, kSettings = 4, kContinuation = 9;
constexpr std::uint8_t kEndStream = 1, kEndHeaders = 4;
const std::string kPreface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

std::string frame(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
                  std::size_t payload_bytes = 0) {
  std::string out;
  for (const int shift : {16, 8, 0}) out += static_cast<char>(payload_bytes >> shift);
  out += static_cast<char>(type);
  out += static_cast<char>(flags);
  for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(stream >> shift);
  // Whatever it is, it is not a frame: it would be one of a header block.
  return out.append(payload_bytes, static_cast<char>(kContinuation));
}
// Return frames of the client's n-th call.
std::string call(std::uint32_t n) { return frame(kHeaders, kEndHeaders, 2 * n + 1, 20); }
std::string cancel(std::uint32_t n) { return frame(kReset, 0, 2 * n + 1, 4); }
std::string answer(std::uint32_t n) {
  return frame(kHeaders, kEndHeaders, 2 * n + 1, 8) + frame(kData, 0, 2 * n + 1, 30) +
         frame(kHeaders, kEndHeaders | kEndStream, 2 * n + 1, 5);
}

struct Connection {
  explicit Connection(FrameTotals& totals) : meter(totals) {
    EXPECT_TRUE(meter.from_client(kPreface + frame(kSettings, 0, 0, 12), 0).ok());
  }
  absl::Status sends(const std::string& bytes, double now_s = 0) {
    return meter.from_client(bytes, now_s);
  }
  absl::Status gets(const std::string& bytes, double now_s = 0) {
    return meter.from_server(bytes, now_s);
  }
  FrameMeter meter;
};

TEST(FrameMeter, CallsThatAreAnsweredAreNotCounted) {
  FrameTotals totals{FrameLimits()};
  Connection worker(totals);
  for (std::uint32_t n = 0; n < 100'000; ++n) {
    ASSERT_TRUE(worker.sends(call(n) + frame(kData, kEndStream, 2 * n + 1, 100)).ok()) << n;
    ASSERT_EQ(totals.streams, 1U);
    ASSERT_TRUE(worker.gets(answer(n)).ok());
    // A client that learns of the end before it has sent all resets a stream that is no more.
    ASSERT_TRUE(worker.sends(cancel(n)).ok());
    ASSERT_EQ(totals.streams, 0U);
  }
}

TEST(FrameMeter, StreamsThatAreOpenAtOnce) {
  FrameTotals totals{FrameLimits()};
  {
    Connection client(totals);
    std::uint32_t n = 0;
    for (; n < totals.limits.most_streams; ++n) ASSERT_TRUE(client.sends(call(n)).ok()) << n;
    EXPECT_THAT(client.sends(call(n)).message(), HasSubstr("more than 32 streams at once"));
  }
  EXPECT_EQ(totals.streams, 0U);
}

TEST(FrameMeter, ResetsAreForgottenWithTime) {
  FrameTotals totals{FrameLimits()};
  Connection client(totals);
  std::uint32_t n = 0;
  double now_s = 1e9;
  for (; n < 50; ++n) ASSERT_TRUE(client.sends(call(n) + cancel(n), now_s).ok()) << n;
  // Five a second, for ever.
  for (; n < 1000; ++n) ASSERT_TRUE(client.sends(call(n) + cancel(n), now_s += 0.2).ok()) << n;
  EXPECT_THAT(client.sends(call(n) + cancel(n), now_s).message(),
              HasSubstr("reset more than 50 streams"));
}

TEST(FrameMeter, ResetsThatTheServerIsMadeToDoCount) {
  FrameTotals totals{FrameLimits()};
  Connection client(totals);
  absl::Status status;
  std::uint32_t n = 0;
  for (; status.ok() && n < 1000; ++n) {
    ASSERT_TRUE(client.sends(call(n)).ok());
    status = client.gets(cancel(n));
  }
  EXPECT_EQ(n, 51U);
  EXPECT_FALSE(status.ok());
}

TEST(FrameMeter, ManyConnectionsTogether) {
  FrameLimits limits;
  limits.most_streams_of_all = 20;
  limits.most_resets_of_all = 30;
  FrameTotals totals(limits);
  Connection a(totals), b(totals), honest(totals);
  for (std::uint32_t n = 0; n < 18; ++n) ASSERT_TRUE(a.sends(call(n)).ok());
  // A worker's few calls are taken in any crowd.
  for (std::uint32_t n = 0; n < 8; ++n) ASSERT_TRUE(honest.sends(call(n)).ok());
  EXPECT_THAT(a.sends(call(18)).message(), HasSubstr("while all connections"));
  // Hanging up is as good as a reset.
  std::optional<Connection> gone(totals);
  for (std::uint32_t n = 0; n < 8; ++n) ASSERT_TRUE(gone->sends(call(n)).ok());
  gone.reset();
  for (std::uint32_t n = 0; n < 22; ++n) ASSERT_TRUE(b.sends(call(n) + cancel(n)).ok()) << n;
  EXPECT_THAT(b.sends(call(22) + cancel(22)).message(), HasSubstr("all connections"));
  EXPECT_TRUE(totals.resets.is_over(0));
  EXPECT_FALSE(totals.resets.is_over(1));
}

TEST(FrameMeter, HeaderBlocks) {
  FrameTotals totals{FrameLimits()};
  {
    Connection client(totals);
    ASSERT_TRUE(client
                    .sends(frame(kHeaders, 0, 1, 8000) + frame(kContinuation, 0, 1, 8000) +
                           frame(kContinuation, kEndHeaders, 1, 384))
                    .ok());
    // The next block, of the same call's trailers, is counted by itself.
    ASSERT_TRUE(client.sends(frame(kHeaders, kEndStream | kEndHeaders, 1, 16384)).ok());
    EXPECT_THAT(client.sends(frame(kHeaders, kEndHeaders, 3, 16385)).message(),
                HasSubstr("more than 16384 bytes"));
  }
  Connection client(totals);
  ASSERT_TRUE(client.sends(frame(kHeaders, 0, 1, 1)).ok());
  for (int i = 1; i < 8; ++i) ASSERT_TRUE(client.sends(frame(kContinuation, 0, 1, 0)).ok());
  EXPECT_THAT(client.sends(frame(kContinuation, 0, 1, 0)).message(),
              HasSubstr("more than 8 frames"));
}

// However the bytes are cut, the same frames are in them.
TEST(FrameMeter, PiecesOfAnySize) {
  std::string bytes = kPreface + frame(kSettings, 0, 0, 12);
  for (std::uint32_t n = 0; n < 51; ++n)
    bytes += call(n) + frame(kData, kEndStream, 2 * n + 1, 70'000) + cancel(n);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{16384}}) {
    FrameTotals totals{FrameLimits()};
    FrameMeter meter(totals);
    std::size_t at = 0;
    absl::Status status;
    for (; at < bytes.size() && status.ok(); at += piece)
      status = meter.from_client(std::string_view(bytes).substr(at, piece), 0);
    EXPECT_FALSE(status.ok()) << piece;
    EXPECT_GT(at + 13 + piece, bytes.size()) << piece;  // the last reset's header
  }
}

}  // namespace
}  // namespace irsig
