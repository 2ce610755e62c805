#include "planning/land_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "core/base/status_macros.h"
#include "core/land/objects/land_objects.h"
#include "planning/accuracy_source.h"
#include "runner/sweep_land.h"
#include "view/draw/axis.h"
#include "view/draw/svg.h"

namespace irsig {
namespace {

Rgb color_of(std::string_view material, std::size_t index) {
  struct Named {
    std::string_view name;
    Rgb color;
  };
  static constexpr std::array kNamed{
      Named{"asphalt", {96, 96, 104}},       Named{"bare_soil_dry", {176, 138, 102}},
      Named{"bare_soil_wet", {124, 94, 70}}, Named{"brick", {172, 92, 72}},
      Named{"concrete", {172, 172, 168}},    Named{"grass", {124, 166, 84}},
      Named{"leaves", {74, 118, 58}},        Named{"sand", {228, 208, 160}},
      Named{"sea_water", {84, 136, 196}},    Named{"snow", {244, 248, 252}},
      Named{"wheat", {218, 194, 112}}};
  static constexpr std::array<Rgb, 6> kOthers{Rgb{204, 121, 167}, {0, 158, 115},  {230, 159, 0},
                                              {86, 180, 233},     {240, 228, 66}, {213, 94, 0}};
  for (const Named& named : kNamed)
    if (named.name == material) return named.color;
  return kOthers[index % kOthers.size()];
}

std::string hex_of(Rgb c) { return fmt::format("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue); }

// A map in pixels: square ones, as many as the long side is asked for.
struct MapPixels {
  double west_m, north_m, pixel_m;
  std::uint32_t width, height;
};
MapPixels pixels_of(const HeightGrid& map, std::uint32_t long_side_px) {
  const double east_m = map.columns * map.spacing_m, north_m = map.rows * map.spacing_m;
  const double pixel_m = std::max(east_m, north_m) / long_side_px;
  const auto count = [&](double side_m) {
    return static_cast<std::uint32_t>(std::max(1.0, std::round(side_m / pixel_m)));
  };
  return {map.west_m, map.south_m + north_m, pixel_m, count(east_m), count(north_m)};
}

// Pixels of a relief, and the heights that they have.
struct Relief {
  std::string png;
  double lowest_m = std::numeric_limits<double>::infinity(), highest_m = -lowest_m;
};
Relief relief_of(const LandScene& land, const GeodeticPosition& origin, const MapPixels& map,
                 const std::vector<Rgb>& color) {
  constexpr double kAboveM = 20'000;  // above all land and what stands on it
  const std::size_t shades = 255 / color.size();
  const HeightGrid& grid = land.field->outer();
  const auto z_at = [&](double x_m, double y_m) {
    const double x = std::clamp(x_m, grid.west_m, grid.west_m + grid.columns * grid.spacing_m);
    const double y = std::clamp(y_m, grid.south_m, grid.south_m + grid.rows * grid.spacing_m);
    return land.field->z_m(x, y).value_or(0);
  };
  std::vector<Rgb> palette;
  for (const Rgb& c : color)
    for (std::size_t s = 0; s < shades; ++s) {
      const double light = 0.3 + 0.9 * (static_cast<double>(s) + 0.5) / static_cast<double>(shades);
      const auto shaded = [&](std::uint8_t channel) {
        return static_cast<std::uint8_t>(std::min(255.0, light * channel));
      };
      palette.push_back({shaded(c.red), shaded(c.green), shaded(c.blue)});
    }
  Relief out;
  std::vector<std::uint8_t> pixel;
  std::vector<float> fraction(land.cover.materials());
  const double half_m = 0.5 * std::max(map.pixel_m, grid.spacing_m);
  for (std::uint32_t row = 0; row < map.height; ++row)
    for (std::uint32_t column = 0; column < map.width; ++column) {
      const double x_m = map.west_m + (column + 0.5) * map.pixel_m;
      const double y_m = map.north_m - (row + 0.5) * map.pixel_m;
      const double dx = (z_at(x_m + half_m, y_m) - z_at(x_m - half_m, y_m)) / (2 * half_m);
      const double dy = (z_at(x_m, y_m + half_m) - z_at(x_m, y_m - half_m)) / (2 * half_m);
      // Light from 45 degrees above the northwest.
      const double lit =
          (0.5 * dx - 0.5 * dy + std::numbers::sqrt2 / 2) / std::sqrt(1 + dx * dx + dy * dy);
      land.cover.at(x_m, y_m, fraction);
      auto most = static_cast<std::size_t>(std::max_element(fraction.begin(), fraction.end()) -
                                           fraction.begin());
      if (land.objects != nullptr)
        if (const auto met = land.objects->first_hit({x_m, y_m, kAboveM}, {0, 0, -1},
                                                     kAboveM - z_at(x_m, y_m)))
          most = met->material;
      const auto shade = static_cast<std::size_t>(
          std::clamp(lit * static_cast<double>(shades), 0.0, static_cast<double>(shades - 1)));
      pixel.push_back(static_cast<std::uint8_t>(most * shades + shade));
      const double height = height_m(origin, {x_m, y_m, z_at(x_m, y_m)});
      out.lowest_m = std::min(out.lowest_m, height);
      out.highest_m = std::max(out.highest_m, height);
    }
  out.png = encode_palette_png(map.width, map.height, pixel, palette);
  return out;
}

}  // namespace

std::string draw_land(const LandScene& land, const GeodeticPosition& origin,
                      const std::vector<std::string>& material, const std::string& title,
                      std::uint32_t long_side_px) {
  constexpr double kLeft = 80, kTop = 70, kBottom = 64, kLegend = 170;
  const MapPixels map = pixels_of(land.field->outer(), long_side_px);
  std::vector<Rgb> color;
  for (std::size_t m = 0; m < material.size(); ++m) color.push_back(color_of(material[m], m));
  const Relief relief = relief_of(land, origin, map, color);
  const double width = map.width, height = map.height;
  Svg svg(kLeft + width + kLegend, kTop + height + kBottom, title);
  svg.text({kLeft, 28}, title, {.size = 18, .bold = true});
  svg.text({kLeft, 52},
           fmt::format("Heights {:.6g} to {:.6g} m above the ellipsoid, light from the northwest",
                       std::round(relief.lowest_m), std::round(relief.highest_m)),
           {});
  svg.image({kLeft, kTop}, width, height, relief.png);
  svg.rect({kLeft, kTop}, width, height, "none", {});
  const DisplayUnit unit =
      map.pixel_m * long_side_px >= 5000 ? DisplayUnit{"km", 1e-3} : DisplayUnit{"m", 1};
  const auto along = [&](double low_m, double high_m) {
    return tight_axis(low_m * unit.factor, high_m * unit.factor, 6);
  };
  const Axis x = along(map.west_m, map.west_m + width * map.pixel_m);
  const Axis y = along(map.north_m - height * map.pixel_m, map.north_m);
  for (std::size_t i = 0; i < x.tick.size(); ++i) {
    const double at = kLeft + x.fraction(x.tick[i]) * width;
    svg.line({at, kTop + height}, {at, kTop + height + 6}, {});
    svg.text({at, kTop + height + 22}, x.label[i], {.anchor = Anchor::kMiddle});
  }
  for (std::size_t i = 0; i < y.tick.size(); ++i) {
    const double at = kTop + (1 - y.fraction(y.tick[i])) * height;
    svg.line({kLeft - 6, at}, {kLeft, at}, {});
    svg.text({kLeft - 10, at + 5}, y.label[i], {.anchor = Anchor::kEnd});
  }
  svg.text({kLeft + width / 2, kTop + height + 48}, "East of the target in " + unit.name,
           {.anchor = Anchor::kMiddle});
  svg.text({24, kTop + height / 2}, "North of the target in " + unit.name,
           {.anchor = Anchor::kMiddle, .rotate_deg = -90});
  const Point target{kLeft - map.west_m / map.pixel_m, kTop + map.north_m / map.pixel_m};
  const double heading = land.heading_deg * std::numbers::pi / 180;
  svg.line(target, {target.x + 18 * std::sin(heading), target.y - 18 * std::cos(heading)},
           {.color = "#d00000", .width = 2, .dash = ""});
  svg.circle(target, 5, "none", {.color = "#d00000", .width = 2, .dash = ""});
  for (std::size_t m = 0; m < material.size(); ++m) {
    const double top = kTop + 24.0 * static_cast<double>(m);
    svg.rect({kLeft + width + 18, top}, 16, 16, hex_of(color[m]), {});
    svg.text({kLeft + width + 42, top + 13}, material[m], {});
  }
  return svg.finish();
}

absl::StatusOr<std::string> land_picture(const std::string& database, const std::string& sweep,
                                         std::uint32_t long_side_px) {
  ASSIGN_OR_RETURN(const auto source, load_accuracy_source(database, sweep));
  const schema::ResolvedSweep& resolved = source.loaded.resolved;
  ASSIGN_OR_RETURN(const auto land, land_from_sweep(resolved, source.loaded.assets));
  if (land == nullptr)
    return absl::InvalidArgumentError("the sweep has no [land]; expected a sweep with a map");
  std::vector<std::string> material;
  for (const schema::LandMaterial& m : resolved.sweep().land().material())
    material.push_back(m.material());
  const schema::Place& place = resolved.sweep().place();
  return draw_land(*land, {place.latitude_deg(), place.longitude_deg(), place.height_m()}, material,
                   resolved.sweep().name() + ", land around the target", long_side_px);
}

}  // namespace irsig
