#include "view/plot/plot_hemisphere.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "view/draw/axis.h"
#include "view/draw/svg.h"

namespace irsig {
namespace {

double hemisphere_rad(double deg) { return deg * std::numbers::pi / 180; }

// The borders between neighbouring values, half-way; `first` and `last` close them.
std::vector<double> borders(const std::vector<double>& at, double first, double last) {
  std::vector<double> out{first};
  for (std::size_t i = 1; i < at.size(); ++i) out.push_back(0.5 * (at[i - 1] + at[i]));
  out.push_back(last);
  return out;
}

void color_bar(Svg& svg, Point corner, double height, const Axis& axis,
               const std::string& quantity) {
  constexpr int kCells = 64;
  constexpr double kWidth = 18;
  for (int i = 0; i < kCells; ++i)
    svg.rect({corner.x, corner.y + height * (1 - (i + 1.0) / kCells)}, kWidth,
             height / kCells + 0.5, map_color((i + 0.5) / kCells), {"", 0, ""});
  for (std::size_t i = 0; i < axis.tick.size(); ++i) {
    const double y = corner.y + height * (1 - axis.fraction(axis.tick[i]));
    svg.line({corner.x + kWidth, y}, {corner.x + kWidth + 5, y}, {"#444444", 1, ""});
    svg.text({corner.x + kWidth + 9, y + 4}, axis.label[i], {.size = 12});
  }
  svg.text({corner.x + kWidth, corner.y - 14}, quantity, {.size = 13, .anchor = Anchor::kMiddle});
}

}  // namespace

std::string plot_hemisphere(const std::string& title, const std::string& quantity,
                            const HemisphereValues& values, double source_zenith_deg) {
  constexpr double kRadius = 230;
  const Point center{290, 330};
  Svg svg(720, 620, title);
  svg.text({360, 32}, title, {.size = 17, .anchor = Anchor::kMiddle, .bold = true});
  const std::vector<double>& zenith = values.zenith_deg;
  const std::vector<double>& azimuth = values.azimuth_deg;
  const std::size_t columns = azimuth.size();
  const double last_step = zenith.size() > 1 ? zenith.back() - zenith[zenith.size() - 2] : 10;
  const std::vector<double> ring =
      borders(zenith, 0, std::min(90.0, zenith.back() + last_step / 2));
  const double rim_deg = std::max(ring.back(), source_zenith_deg);
  const auto at = [&](double zenith_deg, double azimuth_deg) {
    const double r = kRadius * zenith_deg / rim_deg;
    return Point{center.x + r * std::sin(hemisphere_rad(azimuth_deg)),
                 center.y - r * std::cos(hemisphere_rad(azimuth_deg))};
  };
  const auto [low, high] = std::minmax_element(values.value.begin(), values.value.end());
  const Axis axis = tight_axis(*low, *high > *low ? *high : *low + std::max(1e-6, 0.01 * *low), 6);
  // Around the circle: the border before the first azimuth is the one after the last.
  const double wrap = 0.5 * (azimuth.back() - 360 + azimuth.front());
  const std::vector<double> side = borders(azimuth, wrap, wrap + 360);
  for (std::size_t z = 0; z < zenith.size(); ++z)
    for (std::size_t a = 0; a < columns; ++a) {
      std::vector<Point> outline;
      const int steps = std::max(1, static_cast<int>((side[a + 1] - side[a]) / 3));
      for (int i = 0; i <= steps; ++i)
        outline.push_back(at(ring[z + 1], side[a] + (side[a + 1] - side[a]) * i / steps));
      for (int i = steps; i >= 0; --i)
        outline.push_back(at(ring[z], side[a] + (side[a + 1] - side[a]) * i / steps));
      svg.polygon(outline, map_color(axis.fraction(values.value[z * columns + a])));
    }
  for (double tick = 20; tick < rim_deg + 1e-9; tick += 20) {
    svg.circle(center, kRadius * tick / rim_deg, "none", {"#ffffff", 0.5, "3 3"});
    svg.text({at(tick, 45).x, at(tick, 45).y}, fmt::format("{:g}\u00b0", tick),
             {.size = 11, .anchor = Anchor::kMiddle, .color = "#ffffff"});
  }
  for (int a = 0; a < 360; a += 45) {
    const double r = kRadius + 22;
    svg.text({center.x + r * std::sin(hemisphere_rad(a)),
              center.y - r * std::cos(hemisphere_rad(a)) + 5},
             a == 0     ? "0\u00b0 source"
             : a == 180 ? "180\u00b0 mirror"
                        : fmt::format("{}\u00b0", a),
             {.size = 13, .anchor = Anchor::kMiddle});
  }
  const Point s = at(source_zenith_deg, 0);
  for (const double dy : {-6.0, 6.0})
    svg.line({s.x - 6, s.y + dy}, {s.x + 6, s.y - dy}, {"#00a0ff", 2.2, ""});
  color_bar(svg, {600, 120}, 420, axis, quantity);
  svg.text({360, 604},
           "Views from above: zenith outwards, azimuth from the source's. Cross: the source.",
           {.size = 12, .anchor = Anchor::kMiddle, .color = "#444444"});
  return svg.finish();
}

}  // namespace irsig
