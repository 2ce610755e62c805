#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "live/session.h"

namespace irsig {

// Page on which one viewer flies around a target.
struct FlyOptions {
  std::string title;  // of the sweep
  std::vector<std::string>
      condition;  // names of the sweep's conditions: "summer 2025-06-21T01:30:00Z"
  std::vector<std::string> band;
  bool keeps_hours = false;  // the time of day cannot be changed: temperatures are computed
  LiveAsk first;
  std::string address = "127.0.0.1";
  int port = 8018;  // 0: one that is free
  // Returns the text of a sweep file with that one view.
  std::function<absl::StatusOr<std::string>(const LiveAsk&)> sweep_text;
  // Callback: computes the job of that view and stores it; returns a message for people that names
  // the stored result and its place.
  std::function<absl::StatusOr<std::string>(const LiveAsk&)> keep;
  std::function<void(const std::string& url)> on_ready;
};

// Serves the page until SIGINT or SIGTERM. The session must outlive the call. Errors: those of
// serve_guarded. INVALID_ARGUMENT also: an address beyond this machine.
[[nodiscard]] absl::Status serve_flight(LiveSession& session, const FlyOptions& options);

// Encodes a picture for the page: 64 bytes of numbers, a float16 of each pixel's radiance, a byte
// of its error (encoded_error()).
[[nodiscard]] std::string encode_picture(const LivePicture& picture);
// Returns the byte that encodes an error relative to a radiance: 0 to 254 for 1e-4 to 1, rounded
// up; 255: the pixel lies on an edge, and no error is stated.
[[nodiscard]] std::uint8_t encoded_error(double relative, bool edge);
// Rounds to float16, to nearest even, and returns the bits; infinite beyond the range of float16.
[[nodiscard]] std::uint16_t half_of(float value);

}  // namespace irsig
