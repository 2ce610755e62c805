#include "view/plot/plot_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "view/draw/svg.h"
#include "view/plot/plot_frame.h"

namespace irsig {
namespace {

constexpr double kCurvesWidth = 560, kCurvesHeight = 400, kCurvesTop = 74;
constexpr double kCurvesLeft = 74, kCurvesRight = 20, kCurvesAbove = 62, kCurvesBelow = 56,
                 kLegendLine = 22;

Stroke stroke_of(const CurvePanel& panel, std::size_t i) {
  return curve_stroke(panel.curve[i].place.value_or(i));
}

std::vector<LegendEntry> legend_of(const CurvePanel& panel) {
  std::vector<LegendEntry> out;
  for (std::size_t i = 0; i < panel.curve.size(); ++i)
    out.push_back({panel.curve[i].name, stroke_of(panel, i)});
  return out;
}

int per_line(const std::vector<LegendEntry>& legend) {
  // As wide as the page is around the frame's middle.
  return std::min(5, legend_entries_per_line(legend, kCurvesWidth - kCurvesLeft + kCurvesRight));
}

// Returns the height that the legend needs beyond one line.
double more_legend(const CurvePanel& panel) {
  const auto legend = legend_of(panel);
  const auto n = static_cast<std::size_t>(per_line(legend));
  return legend.empty() ? 0 : kLegendLine * static_cast<double>((legend.size() - 1) / n);
}

class Panel {
 public:
  // more: room above the frame for the lines of legends beyond the first.
  Panel(Svg& svg, Point corner, double more, const CurvePanel& panel, const Axis& x, const Axis& y)
      : svg_(svg), corner_(corner), above_(kCurvesAbove + more), panel_(panel), x_(x), y_(y) {}

  void draw() const {
    grid();
    svg_.begin_clip_rect(at(x_.low, y_.high), width(), height());
    for (std::size_t i = 0; i < panel_.curve.size(); ++i) {
      const Curve& c = panel_.curve[i];
      band(c, c.far_low, c.far_high, stroke_of(panel_, i), false);
      band(c, c.low, c.high, stroke_of(panel_, i), true);
    }
    for (std::size_t i = 0; i < panel_.curve.size(); ++i)
      curve(panel_.curve[i], stroke_of(panel_, i));
    svg_.end_group();
    frame();
    const auto legend = legend_of(panel_);
    draw_legend(svg_, {corner_.x + kCurvesLeft + width() / 2, corner_.y + 44}, legend,
                per_line(legend));
  }

 private:
  static double width() { return kCurvesWidth - kCurvesLeft - kCurvesRight; }
  static double height() { return kCurvesHeight - kCurvesAbove - kCurvesBelow; }

  [[nodiscard]] Point at(double x, double y) const {
    return {corner_.x + kCurvesLeft + width() * x_.fraction(x),
            corner_.y + above_ + height() * (1 - y_.fraction(y))};
  }

  void grid() const {
    for (std::size_t i = 0; i < x_.tick.size(); ++i) {
      const Point p = at(x_.tick[i], y_.low);
      svg_.line(p, at(x_.tick[i], y_.high), {"#e3e3e3", 0.8, ""});
      svg_.text({p.x, p.y + 19}, x_.label[i], {.size = 12, .anchor = Anchor::kMiddle});
    }
    for (std::size_t i = 0; i < y_.tick.size(); ++i) {
      const Point p = at(x_.low, y_.tick[i]);
      svg_.line(p, at(x_.high, y_.tick[i]), {"#e3e3e3", 0.8, ""});
      svg_.text({p.x - 7, p.y + 4}, y_.label[i], {.size = 12, .anchor = Anchor::kEnd});
    }
  }

  void band(const Curve& c, const std::vector<double>& low, const std::vector<double>& high,
            const Stroke& stroke, bool with_edges) const {
    if (low.empty()) return;
    std::vector<Point> upper, lower;
    const Stroke edge{stroke.color, 0.7, stroke.dash};
    const auto end_piece = [&] {
      if (upper.size() > 1) {
        if (with_edges) {
          svg_.polyline(upper, edge);
          svg_.polyline(lower, edge);
        }
        upper.insert(upper.end(), lower.rbegin(), lower.rend());
        svg_.polygon(upper, stroke.color, with_edges ? 0.1 : 0.06);
      }
      upper.clear();
      lower.clear();
    };
    for (std::size_t k = 0; k < c.x.size(); ++k) {
      if (!std::isfinite(c.x[k]) || !std::isfinite(low[k]) || !std::isfinite(high[k])) {
        end_piece();
        continue;
      }
      upper.push_back(at(c.x[k], high[k]));
      lower.push_back(at(c.x[k], low[k]));
    }
    end_piece();
  }

  void curve(const Curve& c, const Stroke& stroke) const {
    std::vector<Point> piece;
    const auto end_piece = [&] {
      if (piece.size() > 1) svg_.polyline(piece, stroke);
      piece.clear();
    };
    for (std::size_t k = 0; k < c.x.size(); ++k) {
      if (std::isfinite(c.x[k]) && std::isfinite(c.y[k])) {
        piece.push_back(at(c.x[k], c.y[k]));
        if (c.marks) svg_.circle(piece.back(), 2.6, stroke.color, {"", 0, ""});
      } else {
        end_piece();
      }
    }
    end_piece();
  }

  void frame() const {
    svg_.rect(at(x_.low, y_.high), width(), height(), "none", {"#333333", 1.1, ""});
    const double middle = corner_.x + kCurvesLeft + width() / 2;
    svg_.text({middle, corner_.y + 24}, panel_.title,
              {.size = 15, .anchor = Anchor::kMiddle, .bold = true});
    svg_.text({middle, at(x_.low, y_.low).y + 40}, panel_.x_label,
              {.size = 13, .anchor = Anchor::kMiddle});
    svg_.text({corner_.x + 22, corner_.y + above_ + height() / 2}, panel_.y_label,
              {.size = 13, .anchor = Anchor::kMiddle, .rotate_deg = -90});
  }

  Svg& svg_;
  Point corner_;
  double above_;
  const CurvePanel& panel_;
  const Axis& x_;
  const Axis& y_;
};

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(const std::vector<double>& values) {
    for (const double v : values) {
      if (!std::isfinite(v)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  [[nodiscard]] Extent or_unit() const { return low <= high ? *this : Extent{0, 1}; }
};

}  // namespace

std::string plot_curves(std::string_view title, std::string_view subtitle,
                        const std::vector<CurvePanel>& panels, std::size_t columns) {
  std::vector<double> more;  // of each row of panels
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (i % columns == 0) more.push_back(0);
    more.back() = std::max(more.back(), more_legend(panels[i]));
  }
  Svg svg(kCurvesWidth * static_cast<double>(columns),
          kCurvesTop + kCurvesHeight * static_cast<double>(more.size()) +
              std::accumulate(more.begin(), more.end(), 0.0),
          title);
  svg.text({svg.width_px() / 2, 32}, title, {.size = 19, .anchor = Anchor::kMiddle, .bold = true});
  svg.text({svg.width_px() / 2, 56}, subtitle,
           {.size = 13, .anchor = Anchor::kMiddle, .color = "#666666"});
  double top = kCurvesTop;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const CurvePanel& panel = panels[i];
    Extent across, up;
    for (const Curve& c : panel.curve) {
      across.add(c.x);
      for (const auto& values : {c.y, c.low, c.high, c.far_low, c.far_high}) up.add(values);
    }
    across = across.or_unit();
    up = up.or_unit();
    const Axis x = panel.x ? *panel.x : tight_axis(across.low, across.high, 8);
    const Axis y = panel.y_high > panel.y_low ? tight_axis(panel.y_low, panel.y_high, 5)
                                              : round_axis(up.low, up.high, 5);
    const double row_more = more[i / columns];
    const Point corner{kCurvesWidth * static_cast<double>(i % columns), top};
    Panel(svg, corner, row_more, panel, x, y).draw();
    if (i % columns == columns - 1) top += kCurvesHeight + row_more;
  }
  return svg.finish();
}

}  // namespace irsig
