#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "view/plot/hour_axis.h"
#include "view/plot/plot_curves.h"
#include "view/plot/plot_frame.h"
#include "view/report/hours.h"
#include "view/rows/signature_quantity.h"

namespace irsig {
namespace {

// The names of something in the order in which they come.
class Names {
 public:
  std::size_t place(const std::string& name) {
    const auto found = std::find(name_.begin(), name_.end(), name);
    const auto at = static_cast<std::size_t>(found - name_.begin());
    if (found == name_.end()) name_.push_back(name);
    return at;
  }

 private:
  std::vector<std::string> name_;
};

Axis hour_axis_of(const Hours& hours) {
  double first_h = 0, last_h = 0;
  for (const HourlyValue& v : hours.value) {
    first_h = std::min(first_h, v.at.hour);
    last_h = std::max(last_h, v.at.hour);
  }
  return hour_axis(first_h, last_h);
}

Curve& curve_named(std::vector<Curve>& curves, const std::string& name, std::size_t place) {
  const auto found =
      std::find_if(curves.begin(), curves.end(), [&](const Curve& c) { return c.name == name; });
  if (found != curves.end()) return *found;
  curves.push_back({name, {}, {}, {}, {}, place, true, {}, {}});
  return curves.back();
}

void add(Curve& curve, double x, double y, double low, double high) {
  curve.x.push_back(x);
  curve.y.push_back(y);
  curve.low.push_back(low);
  curve.high.push_back(high);
}

std::vector<CurvePanel> temperature_panels(const Hours& hours, const CurvePanel& like) {
  std::vector<CurvePanel> out;
  Names parts;
  for (const HourlyTemperature& t : hours.temperature) {
    const std::string title = t.at.day + ", computed temperatures";
    if (out.empty() || out.back().title != title) {
      out.push_back(like);
      out.back().title = title;
      out.back().y_label = "Temperature in K";
    }
    add(curve_named(out.back().curve, t.part.part, parts.place(t.part.part)), t.at.hour,
        t.part.mean_k, t.part.coldest_k, t.part.hottest_k);
  }
  // Inner sides of walls: temperatures go into the parts' panel, heat fluxes into a panel of their
  // own.
  for (const HourlyInside& i : hours.inside) {
    const std::string title =
        i.at.day + (i.heat_flux ? ", heat into walls" : ", computed temperatures");
    auto panel =
        std::find_if(out.begin(), out.end(), [&](const CurvePanel& p) { return p.title == title; });
    if (panel == out.end()) {
      panel = out.insert(out.end(), like);
      panel->title = title;
      panel->y_label = "Heat flux in W/m\u00b2";
    }
    const std::string name = "behind " + i.build_up;
    Curve& curve = curve_named(panel->curve, name, parts.place(name));
    curve.marks = false;
    curve.x.push_back(i.at.hour);
    curve.y.push_back(i.value);
  }
  return out;
}

std::vector<CurvePanel> value_panels(const Hours& hours, const CurvePanel& like) {
  const QuantityColumns& quantity = columns_of(hours.quantity);
  std::vector<CurvePanel> out;
  Names days, bands;
  for (const HourlyValue& v : hours.value) {
    const StoredSignature& s = v.row.signature;
    const std::size_t band = bands.place(s.band);
    if (band == out.size()) {
      out.push_back(like);
      out.back().title = band_title(s);
    }
    const double value = s.*quantity.value, error = 2 * s.*quantity.numerical_error;
    Curve& curve = curve_named(out[band].curve, v.at.day, days.place(v.at.day));
    add(curve, v.at.hour, value, value - error, value + error);
    // Beyond the numerical error: the band says how far inputs may have moved the value.
    const double input = 2 * input_uncertainty_of(quantity, s);
    curve.far_low.push_back(value - input);
    curve.far_high.push_back(value + input);
  }
  for (CurvePanel& panel : out) {
    double largest = 0;
    for (const Curve& c : panel.curve)
      for (const double y : c.y) largest = std::max(largest, std::abs(y));
    const DisplayUnit unit = display_unit(largest > 0 ? largest : 1, quantity.unit);
    for (Curve& c : panel.curve)
      for (auto* values : {&c.y, &c.low, &c.high, &c.far_low, &c.far_high})
        for (double& y : *values) y *= unit.factor;
    panel.y_label = fmt::format("{} in {}", quantity.title, unit.name);
  }
  return out;
}

}  // namespace

std::string plot_hours(const Hours& hours) {
  const CurvePanel like{"", hour_label(hours.solar_offset_h), "", {}, 0, 0, hour_axis_of(hours)};
  std::vector<CurvePanel> panels = temperature_panels(hours, like);
  const bool temperatures = !panels.empty();
  const std::vector<CurvePanel> values = value_panels(hours, like);
  const std::size_t columns = std::min<std::size_t>(2, std::max(panels.size(), values.size()));
  panels.insert(panels.end(), values.begin(), values.end());
  const QueryRow& any = hours.value.front().row;
  const std::string title =
      fmt::format("{}, azimuth {:.1f}\u00b0, elevation {:.1f}\u00b0, {}{}", hours.sweep,
                  any.signature.aspect_azimuth_deg, any.signature.aspect_elevation_deg,
                  range_title(any.signature.range_m), any.interpolation ? ", interpolated" : "");
  const bool inputs =
      std::any_of(hours.value.begin(), hours.value.end(), [&](const HourlyValue& v) {
        return !std::isnan(input_uncertainty_of(columns_of(hours.quantity), v.row.signature));
      });
  std::string shaded = temperatures ? "Shaded: from a part's coldest facet to its hottest; values "
                                      "\u00b1 2 numerical errors"
                                    : "Shaded: \u00b1 2 numerical errors";
  if (inputs) shaded += "; lighter: \u00b1 2\u03c3 of uncertain inputs";
  return plot_curves(title, shaded, panels, columns);
}

}  // namespace irsig
