#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "view/draw/png.h"

namespace irsig {

struct Point {
  double x, y;  // pixels, y down
};

struct Stroke {
  std::string color = "#222222";
  double width = 1;
  std::string dash;  // "6 3"; empty: solid
};

enum class Anchor { kStart, kMiddle, kEnd };

struct TextStyle {
  double size = 14;
  Anchor anchor = Anchor::kStart;
  std::string color = "#222222";
  bool bold = false;
  double rotate_deg = 0;  // clockwise, about the point
  bool halo = false;      // white around the letters: readable on any colour
};

// A drawing on white, in the order of the calls. Text may hold Unicode; it is escaped. Coordinates
// are written with 2 decimals, so that the same picture gives the same bytes.
class Svg {
 public:
  Svg(double width_px, double height_px, std::string_view title);

  void line(Point a, Point b, const Stroke& stroke);
  void polyline(const std::vector<Point>& points, const Stroke& stroke);
  void polygon(const std::vector<Point>& points, std::string_view fill, double opacity = 1);
  // Draws several outlines filled as one region (even-odd rule).
  void region(const std::vector<std::vector<Point>>& outlines, std::string_view fill);
  void rect(Point corner, double width, double height, std::string_view fill, const Stroke& stroke);
  void circle(Point center, double radius, std::string_view fill, const Stroke& stroke);
  void text(Point at, std::string_view text, const TextStyle& style);
  // Draws a PNG stretched to a rectangle, with sharp edges between its pixels.
  void image(Point corner, double width, double height, std::string_view png);
  // Clips everything until end_group() to a rectangle or circle.
  void begin_clip_rect(Point corner, double width, double height);
  void begin_clip_circle(Point center, double radius);
  void end_group();

  [[nodiscard]] double width_px() const { return width_; }
  [[nodiscard]] double height_px() const { return height_; }
  [[nodiscard]] std::string finish() const;

 private:
  double width_, height_;
  int clips_ = 0;
  std::string body_;
};

// Returns the style of the k-th curve. The colours (Okabe and Ito) and dash patterns are
// distinguishable under the common colour-vision deficiencies.
[[nodiscard]] Stroke curve_stroke(std::size_t k);

// Maps [0, 1] to a colour, perceptually uniform: matplotlib's "inferno" with 9 nodes and linear
// interpolation. CIE lightness grows by 9.7 to 14.5 from node to node.
[[nodiscard]] Rgb map_rgb(double fraction);
[[nodiscard]] std::string map_color(double fraction);  // "#rrggbb"

}  // namespace irsig
