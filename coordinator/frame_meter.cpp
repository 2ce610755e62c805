#include "coordinator/frame_meter.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// RFC 9113, section 6.
constexpr std::uint8_t kHeaders = 1, kRstStream = 3, kContinuation = 9;
constexpr std::uint8_t kEndStream = 0x1, kEndHeaders = 0x4;
constexpr std::uint8_t kData = 0;

absl::Status too_much(const std::string& what) { return absl::ResourceExhaustedError(what); }

}  // namespace

void LeakyBucket::leak(double now_s) {
  level_ = std::max(0.0, level_ - per_s_ * std::max(0.0, now_s - leaked_at_s_));
  leaked_at_s_ = now_s;
}

void LeakyBucket::add(double now_s) {
  leak(now_s);
  level_ += 1;
}

bool LeakyBucket::is_over(double now_s) {
  leak(now_s);
  return level_ > most_;
}

bool FrameScanner::next(std::string_view& bytes, Frame& frame) {
  const std::size_t skipped = std::min(to_skip_, bytes.size());
  bytes.remove_prefix(skipped);
  to_skip_ -= skipped;
  while (!bytes.empty()) {
    header_[known_++] = static_cast<unsigned char>(bytes.front());
    bytes.remove_prefix(1);
    if (known_ < kHeader) continue;
    known_ = 0;
    const auto number = [this](std::size_t at, std::size_t size) {
      std::uint32_t out = 0;
      for (std::size_t i = at; i < at + size; ++i) out = out << 8 | header_[i];
      return out;
    };
    frame = {number(0, 3), header_[3], header_[4], number(5, 4) & 0x7fffffffU};
    to_skip_ = frame.length;
    return true;
  }
  return false;
}

// Whoever hangs up leaves the server as much to undo as whoever resets all of them.
FrameMeter::~FrameMeter() {
  for (std::size_t i = 0; i < open_.size(); ++i) totals_.resets.add(seen_at_s_);
  totals_.streams -= open_.size();
}

void FrameMeter::close(std::uint32_t stream) { totals_.streams -= open_.erase(stream); }

absl::Status FrameMeter::header_block(const FrameScanner::Frame& frame) {
  const FrameLimits& limits = totals_.limits;
  block_bytes_ += frame.length;
  ++block_frames_;
  if (block_bytes_ > limits.most_header_bytes)
    return too_much(
        absl::StrCat("it sent a header block of more than ", limits.most_header_bytes, " bytes"));
  if (block_frames_ > limits.most_header_frames)
    return too_much(
        absl::StrCat("it sent a header block of more than ", limits.most_header_frames, " frames"));
  if ((frame.flags & kEndHeaders) != 0) {
    block_bytes_ = 0;
    block_frames_ = 0;
  }
  return absl::OkStatus();
}

absl::Status FrameMeter::headers(const FrameScanner::Frame& frame) {
  block_bytes_ = 0;
  block_frames_ = 0;
  RETURN_IF_ERROR(header_block(frame));
  if (frame.stream <= last_stream_) return absl::OkStatus();  // the trailers of an open one
  last_stream_ = frame.stream;
  open_.insert(frame.stream);
  ++totals_.streams;
  const FrameLimits& limits = totals_.limits;
  if (open_.size() > limits.most_streams)
    return too_much(absl::StrCat("it opened more than ", limits.most_streams, " streams at once"));
  if (totals_.streams > limits.most_streams_of_all && open_.size() > limits.few_streams)
    return too_much(absl::StrCat("it opened more than ", limits.few_streams,
                                 " streams at once, while all connections had more than ",
                                 limits.most_streams_of_all));
  return absl::OkStatus();
}

// A stream that its server has ended costs it nothing more.
absl::Status FrameMeter::reset(std::uint32_t stream, double now_s) {
  if (!open_.contains(stream)) return absl::OkStatus();
  close(stream);
  resets_.add(now_s);
  totals_.resets.add(now_s);
  const FrameLimits& limits = totals_.limits;
  if (resets_.is_over(now_s))
    return too_much(absl::StrCat("it reset more than ", limits.most_resets, " streams (and ",
                                 limits.resets_per_s, " a second)"));
  if (totals_.resets.is_over(now_s))
    return too_much(absl::StrCat("it reset a stream, while all connections had reset more than ",
                                 limits.most_resets_of_all));
  return absl::OkStatus();
}

absl::Status FrameMeter::from_client(std::string_view bytes, double now_s) {
  seen_at_s_ = now_s;
  FrameScanner::Frame frame{};
  while (client_.next(bytes, frame)) {
    absl::Status status;
    if (frame.type == kHeaders) status = headers(frame);
    if (frame.type == kContinuation) status = header_block(frame);
    if (frame.type == kRstStream) status = reset(frame.stream, now_s);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status FrameMeter::from_server(std::string_view bytes, double now_s) {
  seen_at_s_ = now_s;
  FrameScanner::Frame frame{};
  while (server_.next(bytes, frame)) {
    const bool ends =
        (frame.type == kHeaders || frame.type == kData) && (frame.flags & kEndStream) != 0;
    if (ends) close(frame.stream);
    // A client can make the server do it, by what breaks a rule of one stream (CVE-2025-8671).
    if (frame.type == kRstStream) RETURN_IF_ERROR(reset(frame.stream, now_s));
  }
  return absl::OkStatus();
}

}  // namespace irsig
