#include "view/pictures/image_regions.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "core/base/status_macros.h"
#include "view/pictures/masks.h"

namespace irsig {
namespace {

absl::StatusOr<ImageRectangle> parse_rectangle(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::vector<std::string> sides =
      absl::StrSplit(equals == std::string::npos ? std::string() : text.substr(equals + 1), ',');
  std::array<std::uint32_t, 4> px{};
  bool good = equals != std::string::npos && equals > 0 && sides.size() == px.size();
  for (std::size_t i = 0; good && i < px.size(); ++i) good = absl::SimpleAtoi(sides[i], &px[i]);
  if (!good)
    return absl::InvalidArgumentError(
        fmt::format("--region {}: expected NAME=x0,y0,x1,y1 in whole pixels from the image's top "
                    "left corner, e.g. --region lawn=10,40,60,56",
                    text));
  if (px[0] >= px[2] || px[1] >= px[3])
    return absl::InvalidArgumentError(
        fmt::format("--region {}: the rectangle is empty; x1 and y1 are the first column and row "
                    "behind it, so that x0 < x1 and y0 < y1",
                    text));
  return ImageRectangle{text.substr(0, equals), px[0], px[1], px[2], px[3]};
}

}  // namespace

absl::StatusOr<std::vector<ImageRectangle>> parse_rectangles(std::span<const std::string> texts) {
  std::vector<ImageRectangle> out;
  std::set<std::string> names;
  for (const std::string& text : texts) {
    ASSIGN_OR_RETURN(auto rectangle, parse_rectangle(text));
    if (!names.insert(rectangle.name).second)
      return absl::InvalidArgumentError(fmt::format(
          "--region {}: a region {} is given before; give each a name of its own, e.g. {}_2", text,
          rectangle.name, rectangle.name));
    out.push_back(std::move(rectangle));
  }
  return out;
}

absl::StatusOr<std::vector<ImageRegion>> rectangle_regions(
    std::span<const ImageRectangle> rectangles, std::uint32_t width_px, std::uint32_t height_px) {
  std::vector<ImageRegion> out;
  for (const ImageRectangle& r : rectangles) {
    if (r.x1_px > width_px || r.y1_px > height_px)
      return absl::InvalidArgumentError(fmt::format(
          "--region {}={},{},{},{}: reaches beyond the image of {} x {} pixels; x1 is at most {} "
          "and y1 at most {}",
          r.name, r.x0_px, r.y0_px, r.x1_px, r.y1_px, width_px, height_px, width_px, height_px));
    ImageRegion& region = out.emplace_back(ImageRegion{r.name, {}});
    for (std::uint32_t y = r.y0_px; y < r.y1_px; ++y)
      for (std::uint32_t x = r.x0_px; x < r.x1_px; ++x) region.pixel.push_back(y * width_px + x);
  }
  return out;
}

std::vector<ImageRegion> part_regions(const StoredSilhouette& silhouette) {
  std::vector<std::string> parts;
  for (const StoredSilhouette::Part& part : silhouette.part) parts.push_back(part.name);
  const std::vector<std::uint16_t> mask = part_mask(silhouette, parts);
  std::vector<ImageRegion> out;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    ImageRegion region{parts[k], {}};
    for (std::uint32_t at = 0; at < mask.size(); ++at)
      if (mask[at] == k + 1) region.pixel.push_back(at);
    if (!region.pixel.empty()) out.push_back(std::move(region));
  }
  ImageRegion& whole = out.emplace_back(ImageRegion{"whole image", {}});
  for (std::uint32_t at = 0; at < mask.size(); ++at) whole.pixel.push_back(at);
  return out;
}

RegionMean region_mean(const ImageRegion& region, const ImageNumbers& image) {
  double radiance = 0, squares = 0, common = 0, target = 0, kelvin = 0, known = 0;
  for (const std::uint32_t at : region.pixel) {
    radiance += static_cast<double>(image.radiance_w_m2_sr[at]);
    const double filled = static_cast<double>(image.filled[at]);
    target += filled;
    const auto add_kelvin = [&](std::span<const float> layer, double weight) {
      if (layer.empty() || !(weight > 0) || !(layer[at] > 0)) return;
      kelvin += weight * static_cast<double>(layer[at]);
      known += weight;
    };
    add_kelvin(image.temperature_k, filled);
    add_kelvin(image.land_temperature_k, 1 - filled);
    if (image.stderr_w_m2_sr.empty()) continue;
    const double error = static_cast<double>(image.stderr_w_m2_sr[at]);
    if (filled > 0 || image.independent_background)
      squares += error * error;
    else
      common += error;
  }
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(region.pixel.size());
  return {radiance / n,
          image.stderr_w_m2_sr.empty() ? kUnknown : std::hypot(std::sqrt(squares), common) / n,
          known > 0 ? kelvin / known : kUnknown, target / n, known / n};
}

}  // namespace irsig
