#include "view/pictures/picture_scale.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"

namespace irsig {

absl::StatusOr<PictureScale> parse_picture_scale(const std::string& text) {
  if (text == "common") return PictureScale{};
  if (text == "own") return PictureScale{PictureScale::Kind::kOwn};
  const std::vector<std::string> ends = absl::StrSplit(text, ',');
  PictureScale out{PictureScale::Kind::kStated};
  if (ends.size() == 2 && absl::SimpleAtod(ends[0], &out.black_w_m2_sr) &&
      absl::SimpleAtod(ends[1], &out.white_w_m2_sr) && out.black_w_m2_sr < out.white_w_m2_sr &&
      std::isfinite(out.black_w_m2_sr) && std::isfinite(out.white_w_m2_sr))
    return out;
  return absl::InvalidArgumentError(fmt::format(
      "thumbnail scale {}: expected common, own, or BLACK,WHITE in W/(m2 sr) as 0,12.5", text));
}

}  // namespace irsig
