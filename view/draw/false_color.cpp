#include "view/draw/false_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "core/base/check.h"
#include "view/draw/axis.h"
#include "view/draw/png.h"
#include "view/draw/svg.h"

namespace irsig {
namespace {

constexpr std::uint8_t kLevels = 255, kNothing = 255;
constexpr double kPictureTop = 78, kEdge = 30, kLongestX = 760, kLongestY = 640;
constexpr double kBarWidth = 26, kBarLeast = 280, kAxisWidth = 92, kLabelHeight = 15;
constexpr double kMostEnlarged = 6;

std::vector<Rgb> colors() {
  std::vector<Rgb> out;
  for (int level = 0; level < kLevels; ++level) out.push_back(map_rgb((level + 0.5) / kLevels));
  out.push_back({0, 0, 0});  // of kNothing
  return out;
}

std::uint8_t level_of(float value, const ColorRange& range) {
  const double level =
      (static_cast<double>(value) - range.low) / (range.high - range.low) * kLevels;
  return std::isnan(level) ? kNothing
                           : static_cast<std::uint8_t>(std::clamp(level, 0.0, kLevels - 1.0));
}

// Not every program that draws SVG leaves pixels alone: some blend neighbours when they enlarge an
// image, and a blend of two colours is that of a third value. So pixels come enlarged, each as
// `times` x `times` of the image.
std::string png_of(const FalseColorPicture& picture, std::uint32_t times) {
  std::vector<std::uint8_t> pixel;
  pixel.reserve(picture.value.size() * times * times);
  for (std::size_t y = 0; y < std::size_t{picture.height_px} * times; ++y)
    for (std::size_t x = 0; x < picture.width_px; ++x)
      pixel.insert(pixel.end(), times,
                   level_of(picture.value[y / times * picture.width_px + x], picture.range));
  return encode_palette_png(picture.width_px * times, picture.height_px * times, pixel, colors(),
                            kNothing);
}

class Bar {
 public:
  Bar(Svg& svg, Point corner, double height, const ColorRange& range)
      : svg_(svg), corner_(corner), height_(height), range_(range) {}

  void draw() {
    std::vector<std::uint8_t> level(kLevels);
    for (std::size_t i = 0; i < level.size(); ++i)
      level[i] = static_cast<std::uint8_t>(kLevels - 1 - i);
    svg_.image(corner_, kBarWidth, height_, encode_palette_png(1, kLevels, level, colors()));
    svg_.rect(corner_, kBarWidth, height_, "none", {"#333333", 1, ""});
  }

  // side: 1 right of the bar, -1 left of it.
  void axis(const BarAxis& axis, int side) {
    const double x = side > 0 ? corner_.x + kBarWidth : corner_.x;
    double above = -std::numeric_limits<double>::infinity();
    for (std::size_t i = axis.at.size(); i-- > 0;) {
      const double fraction = (axis.at[i] - range_.low) / (range_.high - range_.low);
      const double y = corner_.y + height_ * (1 - fraction);
      if (fraction < -1e-9 || fraction > 1 + 1e-9 || y - above < kLabelHeight) continue;
      above = y;
      svg_.line({x, y}, {x + 5 * side, y}, {"#333333", 1, ""});
      svg_.text({x + 9 * side, y + 4.5}, axis.label[i],
                {.size = 13, .anchor = side > 0 ? Anchor::kStart : Anchor::kEnd});
    }
    svg_.text({x + (kAxisWidth - 18) * side, corner_.y + height_ / 2}, axis.title,
              {.size = 13, .anchor = Anchor::kMiddle, .rotate_deg = -90});
  }

 private:
  Svg& svg_;
  Point corner_;
  double height_;
  ColorRange range_;
};

}  // namespace

absl::StatusOr<ColorRange> range_of(const std::vector<float>& values) {
  ColorRange out{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const float v : values) {
    if (std::isnan(v)) continue;
    out.low = std::min(out.low, static_cast<double>(v));
    out.high = std::max(out.high, static_cast<double>(v));
  }
  if (out.low > out.high)
    return absl::NotFoundError("nothing to draw: no pixel shows anything of the target");
  if (out.low == out.high) {
    const double half = out.low == 0 ? 0.5 : 1e-3 * std::abs(out.low);
    out = {out.low - half, out.high + half};
  }
  return out;
}

absl::StatusOr<ColorRange> parse_color_range(const std::string& text) {
  const std::vector<std::string> ends = absl::StrSplit(text, ',');
  ColorRange out{};
  if (ends.size() != 2 || !absl::SimpleAtod(ends[0], &out.low) ||
      !absl::SimpleAtod(ends[1], &out.high) || !std::isfinite(out.low) ||
      !std::isfinite(out.high) || !(out.low < out.high))
    return absl::InvalidArgumentError(
        fmt::format("--scale {}: expected LOW,HIGH, the smaller one first, as 280,320", text));
  return out;
}

BarAxis bar_axis(const std::string& title, const ColorRange& range) {
  Axis axis = tight_axis(range.low, range.high, 8);
  return {title, std::move(axis.tick), std::move(axis.label)};
}

std::string draw_false_color(const FalseColorPicture& picture) {
  IRSIG_CHECK(picture.value.size() ==
              static_cast<std::size_t>(picture.width_px) * picture.height_px);
  const double zoom = std::min(kLongestX / picture.width_px, kLongestY / picture.height_px);
  const double width = zoom * picture.width_px, height = zoom * picture.height_px;
  const double bar_height = std::max(height, kBarLeast);
  const double bar_x = kEdge + width + 24 + (picture.other ? kAxisWidth : 0);
  // As wide as a title needs, DejaVu Sans being 0.6 em wide on average.
  const double page = std::max(bar_x + kBarWidth + kAxisWidth + 12,
                               0.6 * 17 * static_cast<double>(picture.title.size()) + 2 * kEdge);
  Svg svg(page, kPictureTop + bar_height + kEdge, picture.title);
  svg.text({page / 2, 32}, picture.title, {.size = 17, .anchor = Anchor::kMiddle, .bold = true});
  svg.text({page / 2, 55}, picture.subtitle,
           {.size = 13, .anchor = Anchor::kMiddle, .color = "#666666"});
  const Point corner{kEdge, kPictureTop + (bar_height - height) / 2};
  svg.rect(corner, width, height, "#d9dde1", {"", 0, ""});
  svg.image(corner, width, height,
            png_of(picture, static_cast<std::uint32_t>(std::clamp(zoom, 1.0, kMostEnlarged))));
  for (const PictureLabel& label : picture.label)
    svg.text({corner.x + zoom * label.x_px, corner.y + zoom * label.y_px}, label.text,
             {.size = 11, .halo = true});
  Bar bar(svg, {bar_x, kPictureTop}, bar_height, picture.range);
  bar.draw();
  bar.axis(picture.axis, 1);
  if (picture.other) bar.axis(*picture.other, -1);
  return svg.finish();
}

}  // namespace irsig
