#include "view/study_tables/work_precision_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/base/printable.h"
#include "view/draw/svg.h"

namespace irsig {
namespace {

constexpr double kPlotWidth = 430, kPlotHeight = 300, kLegendWidth = 290, kPlotLeft = 84,
                 kAbove = 44, kBelow = 58, kTitleHeight = 70;
constexpr double kPanelWidth = kPlotLeft + kPlotWidth + kLegendWidth,
                 kPanelHeight = kAbove + kPlotHeight + kBelow;

bool drawable(double x, double y) { return std::isfinite(x) && std::isfinite(y) && x > 0 && y > 0; }

// Whole decades that hold all values.
struct Decades {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double value) {
    low = std::min(low, std::log10(value));
    high = std::max(high, std::log10(value));
  }
  void close() {
    if (!(low <= high)) {
      low = -1;
      high = 0;
    }
    low = std::floor(low);
    high = std::max(std::ceil(high), low + 1);
  }
  [[nodiscard]] double fraction(double value) const {
    return (std::log10(value) - low) / (high - low);
  }
};

// "0.1", "100", "1e-05"
std::string decade_name(double exponent) {
  const double value = std::pow(10.0, exponent);
  return absl::StrCat(value);
}

// The k-th marker: disk, square, diamond, triangle, in turn.
void draw_marker(Svg& svg, Point p, std::size_t k, const std::string& color) {
  constexpr double r = 4;
  switch (k % 4) {
    case 0:
      svg.circle(p, r, color, {color, 1, ""});
      break;
    case 1:
      svg.rect({p.x - r, p.y - r}, 2 * r, 2 * r, color, {color, 1, ""});
      break;
    case 2:
      svg.polygon(
          {{p.x, p.y - 1.3 * r}, {p.x + 1.3 * r, p.y}, {p.x, p.y + 1.3 * r}, {p.x - 1.3 * r, p.y}},
          color);
      break;
    default:
      svg.polygon({{p.x, p.y - 1.3 * r}, {p.x + 1.2 * r, p.y + r}, {p.x - 1.2 * r, p.y + r}},
                  color);
  }
}

class LogPanel {
 public:
  LogPanel(Svg& svg, Point corner, const WorkPanel& panel)
      : svg_(svg), corner_(corner), panel_(panel) {
    for (const WorkSeries& s : panel.series)
      for (std::size_t i = 0; i < s.x.size(); ++i)
        if (drawable(s.x[i], s.y[i])) {
          x_.add(s.x[i]);
          y_.add(s.y[i]);
        }
    for (const double t : panel.target) y_.add(t);
    if (panel.reference_error > 0) y_.add(panel.reference_error);
    x_.close();
    y_.close();
  }

  void draw() const {
    if (panel_.reference_error > 0) {
      const Point top = at(std::pow(10.0, x_.low), panel_.reference_error);
      svg_.rect(top, kPlotWidth, corner_.y + kAbove + kPlotHeight - top.y, "#d9d9d9",
                {"#d9d9d9", 0, ""});
      svg_.text({top.x + 6, std::min(top.y + 14, corner_.y + kAbove + kPlotHeight - 4)},
                "error of the reference", {.size = 11, .color = "#666666"});
    }
    grid();
    for (const double t : panel_.target)
      svg_.line(at(std::pow(10.0, x_.low), t), at(std::pow(10.0, x_.high), t),
                {"#888888", 1, "5 4"});
    for (std::size_t k = 0; k < panel_.series.size(); ++k) series(k);
    frame();
    legend();
  }

 private:
  [[nodiscard]] Point at(double x, double y) const {
    return {corner_.x + kPlotLeft + kPlotWidth * x_.fraction(x),
            corner_.y + kAbove + kPlotHeight * (1 - y_.fraction(y))};
  }

  void grid() const {
    const double x0 = std::pow(10.0, x_.low), y0 = std::pow(10.0, y_.low);
    for (double d = x_.low; d <= x_.high; ++d) {
      const double v = std::pow(10.0, d);
      svg_.line(at(v, y0), at(v, std::pow(10.0, y_.high)), {"#dddddd", 0.8, ""});
      svg_.text({at(v, y0).x, at(v, y0).y + 18}, decade_name(d),
                {.size = 12, .anchor = Anchor::kMiddle});
    }
    for (double d = y_.low; d <= y_.high; ++d) {
      const double v = std::pow(10.0, d);
      svg_.line(at(x0, v), at(std::pow(10.0, x_.high), v), {"#dddddd", 0.8, ""});
      svg_.text({at(x0, v).x - 7, at(x0, v).y + 4}, decade_name(d),
                {.size = 12, .anchor = Anchor::kEnd});
    }
  }

  [[nodiscard]] static Stroke stroke(std::size_t k) {
    Stroke s = curve_stroke(k);
    s.width = 1.8;
    return s;
  }

  void series(std::size_t k) const {
    const WorkSeries& s = panel_.series[k];
    std::vector<Point> points;
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (drawable(s.x[i], s.y[i])) points.push_back(at(s.x[i], s.y[i]));
    if (s.joined && points.size() > 1) svg_.polyline(points, stroke(k));
    for (const Point& p : points) draw_marker(svg_, p, k, stroke(k).color);
  }

  void frame() const {
    svg_.rect({corner_.x + kPlotLeft, corner_.y + kAbove}, kPlotWidth, kPlotHeight, "none",
              {"#333333", 1.1, ""});
    svg_.text({corner_.x + kPlotLeft, corner_.y + 26}, panel_.title, {.size = 15, .bold = true});
    svg_.text({corner_.x + kPlotLeft + kPlotWidth / 2, corner_.y + kAbove + kPlotHeight + 40},
              panel_.x_label, {.size = 13, .anchor = Anchor::kMiddle});
    svg_.text({corner_.x + 20, corner_.y + kAbove + kPlotHeight / 2}, panel_.y_label,
              {.size = 13, .anchor = Anchor::kMiddle, .rotate_deg = -90});
  }

  void legend() const {
    Point p{corner_.x + kPlotLeft + kPlotWidth + 14, corner_.y + kAbove + 14};
    for (std::size_t k = 0; k < panel_.series.size(); ++k, p.y += 21) {
      if (panel_.series[k].joined) svg_.line(p, {p.x + 24, p.y}, stroke(k));
      draw_marker(svg_, {p.x + 12, p.y}, k, stroke(k).color);
      svg_.text({p.x + 31, p.y + 4}, panel_.series[k].name, {.size = 12});
    }
  }

  Svg& svg_;
  Point corner_;
  const WorkPanel& panel_;
  Decades x_, y_;
};

std::string escaped_html(const std::string& text) {
  return absl::StrReplaceAll(printable(text),
                             {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

void append_cells(const std::vector<std::string>& cells, const char* tag, std::string& out) {
  absl::StrAppend(&out, "<tr>");
  for (const std::string& cell : cells)
    absl::StrAppend(&out, "<", tag, ">", escaped_html(cell), "</", tag, ">");
  absl::StrAppend(&out, "</tr>\n");
}

// The picture without what only a file of its own has in front.
std::string inline_svg(const std::string& svg) {
  const std::size_t start = svg.find("<svg");
  return start == std::string::npos ? svg : svg.substr(start);
}

}  // namespace

std::string plot_work_precision(std::string_view title, std::string_view subtitle,
                                const std::vector<WorkPanel>& panels, std::size_t columns) {
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  Svg svg(kPanelWidth * static_cast<double>(columns),
          kTitleHeight + kPanelHeight * static_cast<double>(rows), title);
  svg.text({kPlotLeft, 30}, title, {.size = 19, .bold = true});
  svg.text({kPlotLeft, 54}, subtitle, {.size = 13, .color = "#666666"});
  for (std::size_t i = 0; i < panels.size(); ++i)
    LogPanel(svg,
             {kPanelWidth * static_cast<double>(i % columns),
              kTitleHeight + kPanelHeight * static_cast<double>(i / columns)},
             panels[i])
        .draw();
  return svg.finish();
}

std::string html_page(const std::string& title, const std::vector<PageSection>& sections) {
  std::string out = absl::StrCat(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>",
      escaped_html(title),
      "</title>\n<style>\nbody{font-family:sans-serif;max-width:100em;margin:1em "
      "auto;padding:0 1em;color:#222}\nsvg{max-width:100%;height:auto}\n"
      "table{border-collapse:collapse;margin:0.5em 0 1.5em}\n"
      "td,th{border:1px solid #ccc;padding:0.2em 0.6em;text-align:right}\n"
      "td:first-child,th:first-child{text-align:left}\ncaption{text-align:left;font-weight:bold}\n"
      "</style>\n</head>\n<body>\n<h1>",
      escaped_html(title), "</h1>\n");
  for (const PageSection& s : sections) {
    absl::StrAppend(&out, "<h2>", escaped_html(s.heading), "</h2>\n");
    for (const std::string& p : s.paragraph)
      absl::StrAppend(&out, "<p>", escaped_html(p), "</p>\n");
    if (!s.svg.empty()) absl::StrAppend(&out, inline_svg(s.svg), "\n");
    for (const PageTable& t : s.table) {
      absl::StrAppend(&out, "<table>\n<caption>", escaped_html(t.caption), "</caption>\n");
      append_cells(t.header, "th", out);
      for (const auto& row : t.row) append_cells(row, "td", out);
      absl::StrAppend(&out, "</table>\n");
    }
  }
  absl::StrAppend(&out, "</body>\n</html>\n");
  return out;
}

std::string markdown_tables(const std::vector<PageTable>& tables) {
  std::string out;
  const auto line = [&](const std::vector<std::string>& cells) {
    absl::StrAppend(&out, "|");
    for (const std::string& cell : cells) absl::StrAppend(&out, " ", cell, " |");
    absl::StrAppend(&out, "\n");
  };
  for (const PageTable& t : tables) {
    absl::StrAppend(&out, t.caption, "\n\n");
    line(t.header);
    line(std::vector<std::string>(t.header.size(), "---"));
    for (const auto& row : t.row) line(row);
    absl::StrAppend(&out, "\n");
  }
  return out;
}

}  // namespace irsig
