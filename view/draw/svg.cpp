#include "view/draw/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/escaping.h"
#include "core/base/printable.h"

namespace irsig {
namespace {

// XML 1.0 allows neither control characters nor bytes that are not UTF-8.
std::string escaped(std::string_view text) {
  std::string out;
  for (char c : one_line(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// Without "-0.00", so that symmetric pictures have symmetric bytes.
std::string px(double v) {
  std::string s = fmt::format("{:.2f}", v);
  return s == "-0.00" ? "0.00" : s;
}

std::string attributes(const Stroke& stroke) {
  if (stroke.width == 0) return "stroke=\"none\"";
  std::string out = fmt::format("stroke=\"{}\" stroke-width=\"{:g}\"", stroke.color, stroke.width);
  if (!stroke.dash.empty()) out += fmt::format(" stroke-dasharray=\"{}\"", stroke.dash);
  return out;
}

std::string list(const std::vector<Point>& points) {
  std::string out;
  for (const Point& p : points)
    out += fmt::format("{}{},{}", out.empty() ? "" : " ", px(p.x), px(p.y));
  return out;
}

}  // namespace

Svg::Svg(double width_px, double height_px, std::string_view title)
    : width_(width_px), height_(height_px) {
  body_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" "
      "viewBox=\"0 0 {0:g} {1:g}\" "
      "font-family=\"'DejaVu Sans',Verdana,Helvetica,Arial,sans-serif\">\n<title>{2}</title>\n"
      "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#ffffff\"/>\n",
      width_, height_, escaped(title));
}

void Svg::line(Point a, Point b, const Stroke& stroke) {
  body_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>\n", px(a.x), px(a.y),
                       px(b.x), px(b.y), attributes(stroke));
}

void Svg::polyline(const std::vector<Point>& points, const Stroke& stroke) {
  body_ += fmt::format(
      "<polyline points=\"{}\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" "
      "{}/>\n",
      list(points), attributes(stroke));
}

void Svg::polygon(const std::vector<Point>& points, std::string_view fill, double opacity) {
  body_ += fmt::format("<polygon points=\"{}\" fill=\"{}\"", list(points), fill);
  if (opacity < 1) body_ += fmt::format(" fill-opacity=\"{:g}\"", opacity);
  body_ += "/>\n";
}

void Svg::region(const std::vector<std::vector<Point>>& outlines, std::string_view fill) {
  if (outlines.empty()) return;
  std::string d;
  for (const auto& outline : outlines) {
    char command = 'M';
    for (const Point& p : outline) {
      d += fmt::format("{}{:.1f} {:.1f}", command, p.x, p.y);
      command = 'L';
    }
    d += 'Z';
  }
  body_ += fmt::format("<path d=\"{}\" fill=\"{}\" fill-rule=\"evenodd\"/>\n", d, fill);
}

void Svg::rect(Point corner, double width, double height, std::string_view fill,
               const Stroke& stroke) {
  body_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" {}/>\n",
                       px(corner.x), px(corner.y), px(width), px(height), fill, attributes(stroke));
}

void Svg::circle(Point center, double radius, std::string_view fill, const Stroke& stroke) {
  body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" {}/>\n", px(center.x),
                       px(center.y), px(radius), fill, attributes(stroke));
}

void Svg::text(Point at, std::string_view text, const TextStyle& style) {
  constexpr std::array kAnchors{"start", "middle", "end"};
  std::string extra;
  if (style.bold) extra += " font-weight=\"bold\"";
  if (style.halo) extra += " stroke=\"#ffffff\" stroke-width=\"2.5\" paint-order=\"stroke\"";
  if (style.rotate_deg != 0) {
    extra += fmt::format(" transform=\"rotate({:g} {} {})\"", style.rotate_deg, px(at.x), px(at.y));
  }
  body_ += fmt::format(
      "<text x=\"{}\" y=\"{}\" font-size=\"{:g}\" text-anchor=\"{}\" fill=\"{}\"{}>{}</text>\n",
      px(at.x), px(at.y), style.size, kAnchors[static_cast<std::size_t>(style.anchor)], style.color,
      extra, escaped(text));
}

void Svg::image(Point corner, double width, double height, std::string_view png) {
  body_ += fmt::format(
      "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
      "style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>\n",
      px(corner.x), px(corner.y), px(width), px(height),
      absl::Base64Escape({png.data(), png.size()}));
}

void Svg::begin_clip_rect(Point corner, double width, double height) {
  body_ += fmt::format(
      "<clipPath id=\"c{0}\"><rect x=\"{1}\" y=\"{2}\" width=\"{3}\" height=\"{4}\"/></clipPath>\n"
      "<g clip-path=\"url(#c{0})\">\n",
      clips_++, px(corner.x), px(corner.y), px(width), px(height));
}

void Svg::begin_clip_circle(Point center, double radius) {
  body_ += fmt::format(
      "<clipPath id=\"c{0}\"><circle cx=\"{1}\" cy=\"{2}\" r=\"{3}\"/></clipPath>\n"
      "<g clip-path=\"url(#c{0})\">\n",
      clips_++, px(center.x), px(center.y), px(radius));
}

void Svg::end_group() { body_ += "</g>\n"; }

std::string Svg::finish() const { return body_ + "</svg>\n"; }

Stroke curve_stroke(std::size_t k) {
  constexpr std::array kColors{"#0072B2", "#009E73", "#D55E00", "#CC79A7",
                               "#E69F00", "#56B4E9", "#000000"};
  constexpr std::array kDashes{"", "9 4", "3 3", "10 3 2 3"};
  return {kColors[k % kColors.size()], 2.2, kDashes[(k / kColors.size()) % kDashes.size()]};
}

Rgb map_rgb(double fraction) {
  constexpr std::array<std::array<int, 3>, 9> kNodes{{{0x00, 0x00, 0x04},
                                                      {0x21, 0x0c, 0x4a},
                                                      {0x57, 0x10, 0x6e},
                                                      {0x8a, 0x22, 0x6a},
                                                      {0xbc, 0x37, 0x54},
                                                      {0xe4, 0x5a, 0x31},
                                                      {0xf9, 0x8e, 0x09},
                                                      {0xf9, 0xcb, 0x35},
                                                      {0xfc, 0xff, 0xa4}}};
  const double at = std::clamp(fraction, 0.0, 1.0) * (kNodes.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kNodes.size() - 2);
  const double t = at - static_cast<double>(i);
  const auto channel = [&](std::size_t c) {
    return static_cast<std::uint8_t>(std::lround((1 - t) * kNodes[i][c] + t * kNodes[i + 1][c]));
  };
  return {channel(0), channel(1), channel(2)};
}

std::string map_color(double fraction) {
  const Rgb color = map_rgb(fraction);
  return fmt::format("#{:02x}{:02x}{:02x}", color.red, color.green, color.blue);
}

}  // namespace irsig
