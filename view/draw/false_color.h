#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Ticks beside a colour bar, at values of the picture.
struct BarAxis {
  std::string title;
  std::vector<double> at;
  std::vector<std::string> label;
};

// The values at the ends of the colours.
struct ColorRange {
  double low, high;
};

// A text in a picture, from a position [px] relative to the top left corner.
struct PictureLabel {
  double x_px, y_px;
  std::string text;
};

// Values of one quantity, row by row from the top left; NaN: nothing is there.
struct FalseColorPicture {
  std::string title, subtitle;
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<float> value;
  ColorRange range{};  // values outside have the colour of the nearer end
  BarAxis axis;
  std::optional<BarAxis> other{};  // of a quantity that the first determines, on the other side
  std::vector<PictureLabel> label{};
};

// Returns the range from the smallest to the largest value; around a single value, a little more.
// NOT_FOUND: all are NaN.
[[nodiscard]] absl::StatusOr<ColorRange> range_of(const std::vector<float>& values);

// Parses a range such as "0,12.5". INVALID_ARGUMENT: the text is not two finite numbers, the
// smaller one first.
[[nodiscard]] absl::StatusOr<ColorRange> parse_color_range(const std::string& text);

// Returns an axis with round values within the range.
[[nodiscard]] BarAxis bar_axis(const std::string& title, const ColorRange& range);

// Draws the picture with its bar in 255 colours of map_color(), which cover equal intervals. Pixels
// without a value are grey. Returns a complete SVG document with two embedded PNG images, the
// picture and the bar.
[[nodiscard]] std::string draw_false_color(const FalseColorPicture& picture);

}  // namespace irsig
