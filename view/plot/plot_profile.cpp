#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/base/status_macros.h"
#include "view/draw/axis.h"
#include "view/plot/plot_frame.h"
#include "view/report/profile.h"

namespace irsig {
namespace {

constexpr double kProfileLeft = 92, kProfileRight = 26, kProfileBottom = 70, kProfileWidth = 900,
                 kProfileHeight = 600;

struct CurvePoint {
  double x, value, error;
};
struct ProfileCurve {
  std::string name;
  std::vector<CurvePoint> point;
};
struct Mark {
  double x, value;
  std::string relation;
};

absl::Status one_signature(const std::vector<StoredProfileRow>& rows) {
  for (const StoredProfileRow& r : rows)
    if (r.sweep != rows.front().sweep || r.row != rows.front().row)
      return absl::InvalidArgumentError(
          "a profile plot shows one viewpoint, season, time and band of one sweep: choose it with "
          "--row (the first column of the table), and the sweep with --sweep");
  return absl::OkStatus();
}

// One curve for each number of reflections, against the distance from the line's middle.
std::vector<ProfileCurve> curves_along_line(const std::vector<StoredProfileRow>& line) {
  const StoredProfileRow &first = line.front(), &last = line.back();
  const double length =
      std::hypot(last.x_m - first.x_m, last.y_m - first.y_m, last.z_m - first.z_m);
  std::vector<ProfileCurve> curves;
  for (const StoredProfileRow& r : line) {
    const std::string name = fmt::format("N = {}", r.reflections);
    auto curve = std::find_if(curves.begin(), curves.end(),
                              [&](const ProfileCurve& c) { return c.name == name; });
    if (curve == curves.end()) curve = curves.insert(curves.end(), {name, {}});
    const double along = std::hypot(r.x_m - first.x_m, r.y_m - first.y_m, r.z_m - first.z_m);
    if (r.source_radiance_temperature_k > 0)
      curve->point.push_back({along - length / 2, r.source_radiance_temperature_k,
                              2 * r.source_radiance_temperature_stderr_k});
  }
  return curves;
}

// The numbers of reflections in order, each a step of one from the one before it: the last is often
// far beyond the others.
class ReflectionSteps {
 public:
  explicit ReflectionSteps(const std::vector<StoredProfileRow>& rows) {
    for (const StoredProfileRow& r : rows) reflections_.insert(r.reflections);
  }
  [[nodiscard]] double place(std::uint64_t reflections) const {
    return static_cast<double>(std::distance(reflections_.begin(), reflections_.find(reflections)));
  }
  [[nodiscard]] Axis axis() const {
    Axis axis{-0.4, static_cast<double>(reflections_.size()) - 0.6, {}, {}};
    for (const std::uint64_t n : reflections_) {
      axis.tick.push_back(place(n));
      axis.label.push_back(fmt::format("{}", n));
    }
    return axis;
  }

 private:
  std::set<std::uint64_t> reflections_;
};

// One curve for each profile, against the number of reflections.
std::vector<ProfileCurve> curves_over_reflections(const std::vector<StoredProfileRow>& rows,
                                                  const ReflectionSteps& steps) {
  std::vector<ProfileCurve> curves;
  for (const StoredProfileRow& r : rows) {
    if (curves.empty() || curves.back().name != r.profile) curves.push_back({r.profile, {}});
    if (r.source_radiance_temperature_k > 0)
      curves.back().point.push_back({steps.place(r.reflections), r.source_radiance_temperature_k,
                                     2 * r.source_radiance_temperature_stderr_k});
  }
  return curves;
}

class Chart {
 public:
  Chart(Svg& svg, double top, const Axis& x, const Axis& y) : svg_(svg), top_(top), x_(x), y_(y) {}

  [[nodiscard]] Point at(double x, double y) const {
    return {kProfileLeft + (kProfileWidth - kProfileLeft - kProfileRight) * x_.fraction(x),
            top_ + (kProfileHeight - top_ - kProfileBottom) * (1 - y_.fraction(y))};
  }

  void frame(const std::string& x_title) {
    for (std::size_t i = 0; i < x_.tick.size(); ++i) {
      const Point p = at(x_.tick[i], y_.low);
      svg_.line(p, at(x_.tick[i], y_.high), {"#e3e3e3", 0.8, ""});
      svg_.text({p.x, p.y + 20}, x_.label[i], {.size = 13, .anchor = Anchor::kMiddle});
    }
    for (std::size_t i = 0; i < y_.tick.size(); ++i) {
      const Point p = at(x_.low, y_.tick[i]);
      svg_.line(p, at(x_.high, y_.tick[i]), {"#e3e3e3", 0.8, ""});
      svg_.text({p.x - 8, p.y + 4.5}, y_.label[i], {.size = 13, .anchor = Anchor::kEnd});
    }
    const Point corner = at(x_.low, y_.high), end = at(x_.high, y_.low);
    svg_.rect(corner, end.x - corner.x, end.y - corner.y, "none", {"#333333", 1.2, ""});
    svg_.text({(corner.x + end.x) / 2, end.y + 46}, x_title,
              {.size = 15, .anchor = Anchor::kMiddle});
    svg_.text({26, (corner.y + end.y) / 2}, "Source radiance temperature in K",
              {.size = 15, .anchor = Anchor::kMiddle, .rotate_deg = -90});
  }

  void curve(const ProfileCurve& c, const Stroke& stroke, bool dots) {
    std::vector<Point> edge, line;
    for (const CurvePoint& p : c.point) {
      edge.push_back(at(p.x, p.value + p.error));
      line.push_back(at(p.x, p.value));
    }
    for (std::size_t k = c.point.size(); k-- > 0;)
      edge.push_back(at(c.point[k].x, c.point[k].value - c.point[k].error));
    svg_.polygon(edge, stroke.color, 0.2);
    svg_.polyline(line, stroke);
    if (dots)
      for (const Point& p : line) svg_.circle(p, 3, stroke.color, {"", 0, ""});
  }

  // A published number: a ring; a limit has a stroke to the side where the number lies.
  void mark(const Mark& m) {
    const Point p = at(m.x, m.value);
    svg_.circle(p, 6, "none", {"#222222", 1.5, ""});
    if (m.relation == "below") svg_.line(p, {p.x, p.y + 18}, {"#222222", 1.5, ""});
    if (m.relation == "above") svg_.line(p, {p.x, p.y - 18}, {"#222222", 1.5, ""});
  }

 private:
  Svg& svg_;
  double top_;
  const Axis& x_;
  const Axis& y_;
};

}  // namespace

absl::StatusOr<std::string> plot_profile(const std::vector<StoredProfileRow>& rows,
                                         const std::vector<StoredPublished>& published) {
  if (rows.empty()) return absl::NotFoundError("nothing to plot: no profile matches the filters");
  RETURN_IF_ERROR(one_signature(rows));

  // The first profile along a line, if there is one.
  std::vector<StoredProfileRow> line;
  for (const StoredProfileRow& r : rows) {
    if (r.point_index == 0) continue;
    for (const StoredProfileRow& s : rows)
      if (s.profile_index == r.profile_index) line.push_back(s);
    break;
  }
  const ReflectionSteps steps(rows);
  std::vector<Mark> marks;
  if (line.empty())
    for (const StoredPublished& p : published)
      for (const StoredProfileRow& r : rows)
        if (p.sweep == r.sweep && p.profile == r.profile && p.reflections == r.reflections)
          marks.push_back(
              {steps.place(p.reflections), p.source_radiance_temperature_k, p.relation});
  const std::vector<ProfileCurve> curves =
      line.empty() ? curves_over_reflections(rows, steps) : curves_along_line(line);

  double x_low = HUGE_VAL, x_high = -HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;
  for (const ProfileCurve& c : curves)
    for (const CurvePoint& p : c.point) {
      x_low = std::min(x_low, p.x);
      x_high = std::max(x_high, p.x);
      low = std::min(low, p.value - p.error);
      high = std::max(high, p.value + p.error);
    }
  for (const Mark& m : marks) {
    low = std::min(low, m.value);
    high = std::max(high, m.value);
  }
  if (!(low <= high)) return absl::NotFoundError("nothing to plot: no radiance anywhere");

  const StoredProfileRow& any = rows.front();
  const std::string title =
      line.empty() ? any.sweep : fmt::format("{}: {}", any.sweep, line.front().profile);
  const std::string subtitle =
      fmt::format("{}, {} ({:g}\u2013{:g} \u00b5m), azimuth {:g}\u00b0, elevation {:g}\u00b0, {}",
                  any.season, any.band, any.lambda_min_um, any.lambda_max_um,
                  any.aspect_azimuth_deg, any.aspect_elevation_deg, range_title(any.range_m));
  Svg svg(kProfileWidth, kProfileHeight, title);
  svg.text({kProfileWidth / 2, 30}, title, {.size = 19, .anchor = Anchor::kMiddle, .bold = true});
  svg.text({kProfileWidth / 2, 52}, subtitle, {.size = 14, .anchor = Anchor::kMiddle});
  std::vector<LegendEntry> legend;
  std::size_t longest = 0;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    legend.push_back({curves[k].name, curve_stroke(k)});
    longest = std::max(longest, curves[k].name.size());
  }
  const int per_line = longest > 16 ? 3 : longest > 8 ? 4 : 7;
  draw_legend(svg, {kProfileWidth / 2, 78}, legend, per_line);
  const auto n = static_cast<std::size_t>(per_line);
  const double top = 78 + 22 * static_cast<double>((legend.size() + n - 1) / n);
  const double margin = 0.03 * (x_high - x_low);
  const Axis x = line.empty() ? steps.axis() : tight_axis(x_low - margin, x_high + margin, 10);
  const Axis y = round_axis(low, high, 8);
  Chart chart(svg, top, x, y);
  chart.frame(line.empty() ? "Number of reflections" : "Distance along the profile in m");
  for (std::size_t k = 0; k < curves.size(); ++k)
    chart.curve(curves[k], curve_stroke(k), line.empty());
  for (const Mark& m : marks) chart.mark(m);
  return svg.finish();
}

}  // namespace irsig
