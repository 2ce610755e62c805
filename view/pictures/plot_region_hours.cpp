#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/accuracy/image_layers.h"
#include "view/pictures/region_hours.h"
#include "view/plot/hour_axis.h"
#include "view/plot/plot_curves.h"
#include "view/plot/plot_frame.h"

namespace irsig {
namespace {

// Colours of regions, the same in all panels.
using RegionPlaces = std::map<std::string, std::size_t>;

RegionPlaces region_places(const RegionHours& hours) {
  RegionPlaces out;
  for (const RegionValue& v : hours.value) out.try_emplace(v.region, out.size());
  return out;
}

Axis axis_of(const RegionHours& hours) {
  double first_h = 0, last_h = 0;
  for (const RegionValue& v : hours.value) {
    first_h = std::min(first_h, v.at.hour);
    last_h = std::max(last_h, v.at.hour);
  }
  return hour_axis(first_h, last_h);
}

// Values are sorted: a region's curve is the last one, or new.
Curve& region_curve(CurvePanel& panel, const std::string& name, std::size_t place) {
  if (panel.curve.empty() || panel.curve.back().place != place)
    panel.curve.push_back({name, {}, {}, {}, {}, place, true, {}, {}});
  return panel.curve.back();
}

std::string day_title(const std::string& what, const std::string& day, bool several) {
  return several ? day + ", " + what : what;
}

struct DayPanels {
  std::string day;
  std::vector<CurvePanel> radiance;  // of each band
  CurvePanel temperature;            // without curves: none is stored
};

std::vector<DayPanels> panels_of_days(const RegionHours& hours, const CurvePanel& like) {
  const RegionPlaces places = region_places(hours);
  const bool several = hours.value.front().at.day != hours.value.back().at.day;
  std::vector<DayPanels> out;
  std::string band;
  for (const RegionValue& v : hours.value) {
    if (out.empty() || out.back().day != v.at.day) {
      out.push_back({v.at.day, {}, like});
      out.back().temperature.title = day_title("Temperature", v.at.day, several);
      out.back().temperature.y_label = "Temperature in K";
      band.clear();
    }
    DayPanels& day = out.back();
    if (day.radiance.empty() || band != v.row.band) {
      day.radiance.push_back(like);
      day.radiance.back().title = day_title(band_title(v.row), v.at.day, several);
      day.radiance.back().y_label = "Radiance in W/(m\u00b2 sr)";
      band = v.row.band;
    }
    const std::size_t place = places.at(v.region);
    Curve& radiance = region_curve(day.radiance.back(), v.region, place);
    radiance.x.push_back(v.at.hour);
    radiance.y.push_back(v.mean.radiance_w_m2_sr);
    radiance.low.push_back(v.mean.radiance_w_m2_sr - 2 * v.mean.stderr_w_m2_sr);
    radiance.high.push_back(v.mean.radiance_w_m2_sr + 2 * v.mean.stderr_w_m2_sr);
    // Temperatures are those of a condition, the same in each band.
    if (day.radiance.size() > 1 || std::isnan(v.mean.temperature_k)) continue;
    const double percent = 100 * v.mean.known_fraction;
    const std::string name =
        percent > 99.5 ? v.region : fmt::format("{}, {:.2g} %", v.region, percent);
    Curve& temperature = region_curve(day.temperature, name, place);
    temperature.x.push_back(v.at.hour);
    temperature.y.push_back(v.mean.temperature_k);
  }
  return out;
}

}  // namespace

std::string plot_region_hours(const RegionHours& hours) {
  const CurvePanel like{"", hour_label(hours.solar_offset_h), "", {}, 0, 0, axis_of(hours)};
  std::vector<DayPanels> days = panels_of_days(hours, like);
  std::vector<CurvePanel> panels;
  bool temperatures = false;
  std::size_t most = 0;
  for (DayPanels& day : days) {
    if (!day.temperature.curve.empty()) {
      temperatures = true;
      day.radiance.push_back(std::move(day.temperature));
    }
    most = std::max(most, day.radiance.size());
    std::move(day.radiance.begin(), day.radiance.end(), std::back_inserter(panels));
  }
  // Panels of a day side by side, if all days have as many.
  const bool aligned = panels.size() == most * days.size();
  const std::size_t columns = aligned && most <= 3 ? most : std::min<std::size_t>(2, panels.size());
  const StoredSignature& any = hours.value.front().row;
  const std::string title =
      fmt::format("{}, azimuth {:.1f}\u00b0, elevation {:.1f}\u00b0, {}", hours.sweep,
                  any.aspect_azimuth_deg, any.aspect_elevation_deg, range_title(any.range_m));
  const bool errors = std::any_of(hours.value.begin(), hours.value.end(),
                                  [](const auto& v) { return !std::isnan(v.mean.stderr_w_m2_sr); });
  std::string subtitle = fmt::format("Means over regions of the images, layer {}", hours.layer);
  if (errors) subtitle += "; shaded: \u00b1 2 standard errors";
  if (temperatures)
    subtitle += "; temperatures: where known, with the percentage of the region unless it is all";
  return plot_curves(title, subtitle, panels, columns);
}

}  // namespace irsig
