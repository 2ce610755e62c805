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
  // Several outlines filled as one region (even-odd).
  void region(const std::vector<std::vector<Point>>& outlines, std::string_view fill);
  void rect(Point corner, double width, double height, std::string_view fill, const Stroke& stroke);
  void circle(Point center, double radius, std::string_view fill, const Stroke& stroke);
  void text(Point at, std::string_view text, const TextStyle& style);
  // A PNG stretched to a rectangle, each pixel a rectangle of its own.
  void image(Point corner, double width, double height, std::string_view png);
  // Everything until end_group() is clipped to a rectangle or circle.
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

// The k-th of a set of distinguishable colours (Okabe and Ito: safe for the common colour-vision
// deficiencies) and dash patterns, for curves in order.
[[nodiscard]] Stroke curve_stroke(std::size_t k);

// Perceptually uniform map from [0, 1] to a colour ("inferno" of matplotlib, 9 nodes, linear
// between: CIE lightness grows by 9.7 to 14.5 from node to node).
[[nodiscard]] Rgb map_rgb(double fraction);
[[nodiscard]] std::string map_color(double fraction);  // "#rrggbb"

}  // namespace irsig
