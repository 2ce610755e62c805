#include "view/plot_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "view/axis.h"
#include "view/plot_frame.h"
#include "view/svg.h"

namespace irsig {
namespace {

constexpr double kPanelWidth = 560, kPanelHeight = 400, kTop = 74;
constexpr double kLeft = 74, kRight = 20, kAbove = 62, kBelow = 56;

class Panel {
 public:
  Panel(Svg& svg, Point corner, const CurvePanel& panel, const Axis& x, const Axis& y)
      : svg_(svg), corner_(corner), panel_(panel), x_(x), y_(y) {}

  void draw() const {
    grid();
    svg_.begin_clip_rect(at(x_.low, y_.high), width(), height());
    for (std::size_t i = 0; i < panel_.curve.size(); ++i) curve(panel_.curve[i], curve_stroke(i));
    svg_.end_group();
    frame();
    std::vector<LegendEntry> legend;
    for (std::size_t i = 0; i < panel_.curve.size(); ++i)
      legend.push_back({panel_.curve[i].name, curve_stroke(i)});
    draw_legend(svg_, {corner_.x + kLeft + width() / 2, corner_.y + 44}, legend, 5);
  }

 private:
  static double width() { return kPanelWidth - kLeft - kRight; }
  static double height() { return kPanelHeight - kAbove - kBelow; }

  [[nodiscard]] Point at(double x, double y) const {
    return {corner_.x + kLeft + width() * x_.fraction(x),
            corner_.y + kAbove + height() * (1 - y_.fraction(y))};
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

  void curve(const Curve& c, const Stroke& stroke) const {
    std::vector<Point> piece;
    const auto end_piece = [&] {
      if (piece.size() > 1) svg_.polyline(piece, stroke);
      piece.clear();
    };
    for (std::size_t k = 0; k < c.x.size(); ++k) {
      if (std::isfinite(c.x[k]) && std::isfinite(c.y[k]))
        piece.push_back(at(c.x[k], c.y[k]));
      else
        end_piece();
    }
    end_piece();
  }

  void frame() const {
    svg_.rect(at(x_.low, y_.high), width(), height(), "none", {"#333333", 1.1, ""});
    const double middle = corner_.x + kLeft + width() / 2;
    svg_.text({middle, corner_.y + 24}, panel_.title,
              {.size = 15, .anchor = Anchor::kMiddle, .bold = true});
    svg_.text({middle, corner_.y + kPanelHeight - kBelow + 40}, panel_.x_label,
              {.size = 13, .anchor = Anchor::kMiddle});
    svg_.text({corner_.x + 22, corner_.y + kAbove + height() / 2}, panel_.y_label,
              {.size = 13, .anchor = Anchor::kMiddle, .rotate_deg = -90});
  }

  Svg& svg_;
  Point corner_;
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
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  Svg svg(kPanelWidth * static_cast<double>(columns),
          kTop + kPanelHeight * static_cast<double>(rows), title);
  svg.text({svg.width_px() / 2, 32}, title, {.size = 19, .anchor = Anchor::kMiddle, .bold = true});
  svg.text({svg.width_px() / 2, 56}, subtitle,
           {.size = 13, .anchor = Anchor::kMiddle, .color = "#666666"});
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const CurvePanel& panel = panels[i];
    Extent across, up;
    for (const Curve& c : panel.curve) {
      across.add(c.x);
      up.add(c.y);
    }
    across = across.or_unit();
    up = up.or_unit();
    const Axis x = tight_axis(across.low, across.high, 8);
    const Axis y = panel.y_high > panel.y_low ? tight_axis(panel.y_low, panel.y_high, 5)
                                              : round_axis(up.low, up.high, 5);
    const Point corner{kPanelWidth * static_cast<double>(i % columns),
                       kTop + kPanelHeight * static_cast<double>(i / columns)};
    Panel(svg, corner, panel, x, y).draw();
  }
  return svg.finish();
}

}  // namespace irsig
