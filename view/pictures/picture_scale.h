#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace irsig {

// Black and white of exported pictures.
struct PictureScale {
  // kCommon: from 0 to the hottest pixel of all pictures of a sweep and band. kOwn: from 0 to the
  // hottest pixel of each.
  enum class Kind { kCommon, kOwn, kStated } kind = Kind::kCommon;
  double black_w_m2_sr = 0, white_w_m2_sr = 0;  // kStated
};

// Parses "common", "own" or "BLACK,WHITE". INVALID_ARGUMENT: any other text.
[[nodiscard]] absl::StatusOr<PictureScale> parse_picture_scale(const std::string& text);

}  // namespace irsig
