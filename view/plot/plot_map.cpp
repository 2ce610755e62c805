#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/status_macros.h"
#include "view/draw/axis.h"
#include "view/draw/contour.h"
#include "view/plot/plot.h"
#include "view/plot/plot_frame.h"

namespace irsig {
namespace {

constexpr std::size_t kMapNodes =
    91;  // 2.3 deg at the centre: finer than any set that is worth a map
constexpr int kLevelsPerTick = 4;

double map_rad(double deg) { return deg * std::numbers::pi / 180; }

// Lambert azimuthal equal-area projection, zenith in the centre, bow up, seen from above.
// [snyder1987, eq. 24-1]
class Disk {
 public:
  Disk(Point center, double radius, double rim_zenith_deg)
      : center_(center), radius_(radius), scale_(radius / std::sin(map_rad(rim_zenith_deg) / 2)) {}
  [[nodiscard]] Point at(double azimuth_deg, double elevation_deg) const {
    const double r = scale_ * std::sin(map_rad(90 - elevation_deg) / 2);
    return {center_.x + r * std::sin(map_rad(azimuth_deg)),
            center_.y - r * std::cos(map_rad(azimuth_deg))};
  }
  // Points outside the disk stand for the nearest point of its rim, so that contours run on to it.
  [[nodiscard]] Vec<Body> direction(Point p) const {
    const double x = p.x - center_.x, y = center_.y - p.y;
    const double r = std::min(std::hypot(x, y), radius_);
    const double azimuth_deg = std::atan2(x, y) * 180 / std::numbers::pi;
    const double zenith_deg = 2 * std::asin(r / scale_) * 180 / std::numbers::pi;
    return body_from_aspect(azimuth_deg, 90 - zenith_deg);
  }
  [[nodiscard]] Point center() const { return center_; }
  [[nodiscard]] double radius() const { return radius_; }

 private:
  Point center_;
  double radius_, scale_;
};

template <typename Value>
ValueGrid sampled(const Disk& disk, std::size_t nodes, const Value& value) {
  ValueGrid grid{nodes,
                 nodes,
                 {disk.center().x - disk.radius(), disk.center().y - disk.radius()},
                 2 * disk.radius() / static_cast<double>(nodes - 1),
                 {}};
  for (std::size_t y = 0; y < nodes; ++y) {
    for (std::size_t x = 0; x < nodes; ++x) {
      grid.value.push_back(
          value(disk.direction({grid.corner.x + grid.step * static_cast<double>(x),
                                grid.corner.y + grid.step * static_cast<double>(y)})));
    }
  }
  return grid;
}

int levels_of(const Axis& scale) {
  return kLevelsPerTick * static_cast<int>(scale.tick.size() - 1);
}

void draw_surface(Svg& svg, const Disk& disk, const SphereSurface& surface,
                  const SphereSamples& samples, const Axis& scale) {
  const int levels = levels_of(scale);
  const ValueGrid grid = sampled(disk, kMapNodes, [&](Vec<Body> d) { return surface.value(d); });
  svg.begin_clip_circle(disk.center(), disk.radius());
  svg.circle(disk.center(), disk.radius(), map_color(0.5 / levels), {"", 0, ""});
  for (int i = 1; i < levels; ++i) {
    const double level = scale.low + (scale.high - scale.low) * i / levels;
    svg.region(outlines(grid, level), map_color((i + 0.5) / levels));
  }
  // Where no viewpoints are there is no colour.
  const ValueGrid mask =
      sampled(disk, 61, [&](Vec<Body> d) { return uncovered(samples, d).empty() ? 0.0 : 1.0; });
  svg.region(outlines(mask, 0.5), "#e6e6e6");
  svg.end_group();
}

void draw_graticule(Svg& svg, const Disk& disk, double rim_zenith_deg, bool labels) {
  for (int elevation : {30, 60}) {
    const double r = disk.center().y - disk.at(0, elevation).y;
    svg.circle(disk.center(), r, "none", {"#ffffff", 0.7, "2 3"});
    svg.text({disk.center().x + 4, disk.center().y - r - 3}, fmt::format("{}\u00b0", elevation),
             {.size = 11, .color = "#ffffff"});
  }
  if (rim_zenith_deg > 91) {
    svg.circle(disk.center(), disk.center().y - disk.at(0, 0).y, "none", {"#ffffff", 0.9, ""});
  }
  svg.circle(disk.center(), disk.radius(), "none", {"#333333", 1.2, ""});
  for (int azimuth = 0; azimuth < 360; azimuth += 45) {
    const double s = std::sin(map_rad(azimuth)), c = std::cos(map_rad(azimuth)), r = disk.radius();
    svg.line({disk.center().x + r * s, disk.center().y - r * c},
             {disk.center().x + (r + 5) * s, disk.center().y - (r + 5) * c}, {"#333333", 1.2, ""});
    if (!labels && azimuth % 180 != 0) continue;  // beside each other they would run into one
    const char* side = azimuth == 0 ? " bow" : azimuth == 180 ? " stern" : "";
    const Anchor anchor = s > 0.1 ? Anchor::kStart : s < -0.1 ? Anchor::kEnd : Anchor::kMiddle;
    svg.text({disk.center().x + (r + 9) * s, disk.center().y - (r + 13) * c + 4.5},
             fmt::format("{}\u00b0{}", azimuth, side), {.size = 12, .anchor = anchor});
  }
}

void draw_color_bar(Svg& svg, Point corner, double height, const Axis& scale) {
  constexpr double kWidth = 16;
  const int levels = levels_of(scale);
  for (int i = 0; i < levels; ++i) {
    svg.rect({corner.x, corner.y + height * (levels - 1 - i) / levels}, kWidth,
             height / levels + 0.3, map_color((i + 0.5) / levels), {"", 0, ""});
  }
  svg.rect(corner, kWidth, height, "none", {"#333333", 1, ""});
  for (std::size_t i = 0; i < scale.tick.size(); ++i) {
    const double y = corner.y + height * (1 - scale.fraction(scale.tick[i]));
    svg.line({corner.x + kWidth, y}, {corner.x + kWidth + 5, y}, {"#333333", 1, ""});
    svg.text({corner.x + kWidth + 9, y + 4}, scale.label[i], {.size = 12});
  }
}

struct MapPanel {
  std::size_t line, column;  // band, season and time
  const SignatureField* field;
  SphereSurface surface;
};

}  // namespace

absl::StatusOr<std::string> plot_map(StoreReader& reader, const Query& query,
                                     const ExtentOf& extent_of) {
  if (query.aspect || query.row) {
    return absl::InvalidArgumentError("a map shows all aspects: leave out the aspect and the row");
  }
  if (query.range_m.size() > 1)
    return absl::InvalidArgumentError("a map shows one range: expected one of them in --range-m");
  ASSIGN_OR_RETURN(auto signatures, signatures_to_plot(reader, query, extent_of));
  const CurveNames names(signatures);
  const std::vector<SignatureField> fields = fields_of(signatures, query.quantity);
  const QuantityColumns& quantity = columns_of(query.quantity);
  std::vector<std::string> bands;
  std::vector<MapPanel> panels;
  double lowest_deg = 0;
  for (const SignatureField& field : fields) {
    const StoredSignature& s = field.signature.front();
    auto band = std::find(bands.begin(), bands.end(), s.band);
    if (band == bands.end()) band = bands.insert(band, s.band);
    ASSIGN_OR_RETURN(auto surface, SphereSurface::create(field.samples));
    for (const auto& v : field.signature) lowest_deg = std::min(lowest_deg, v.aspect_elevation_deg);
    panels.push_back({static_cast<std::size_t>(band - bands.begin()), names.index(s), &field,
                      std::move(surface)});
  }
  if (names.size() > 6) {
    return absl::InvalidArgumentError(
        fmt::format("{} seasons and times do not fit on one map: choose with --season and --time "
                    "(at most 6)",
                    names.size()));
  }
  // The whole lower hemisphere makes the projection's rim a point: it is drawn down to -85 deg.
  const double rim_zenith_deg = lowest_deg < -0.5 ? std::min(175.0, 90 - lowest_deg) : 90;

  const auto columns = static_cast<double>(names.size()), lines = static_cast<double>(bands.size());
  const double left = columns == 1 ? 60 : 30, right = 120;
  const double pitch = (900 - left - right) / columns;
  const double radius = std::min(pitch / 2 - (columns == 1 ? 60 : 36), 300.0);
  const double line_height = 2 * radius + 92;
  const StoredSignature& any = signatures.front();
  const std::string title = fmt::format("{}, {}", any.sweep, range_title(any.range_m));
  Svg svg(900, 56 + line_height * lines + 34, title);
  svg.text({450, 32}, title, {.size = 19, .anchor = Anchor::kMiddle, .bold = true});

  for (std::size_t line = 0; line < bands.size(); ++line) {
    double least = 0, most = 0;
    bool first = true;
    const StoredSignature* of_band = nullptr;
    for (const MapPanel& p : panels) {
      if (p.line != line) continue;
      of_band = &p.field->signature.front();
      for (double v : p.field->samples.value) {
        least = first ? v : std::min(least, v);
        most = first ? v : std::max(most, v);
        first = false;
      }
    }
    // From 0 unless that would waste half of the colours.
    if (least > 0 && least < 0.5 * most) least = 0;
    const DisplayUnit unit = display_unit(std::max(most, -least), quantity.unit);
    const Axis scale = round_axis(least, most, 6, unit.factor);
    const double y = 56 + line_height * static_cast<double>(line);
    svg.text({450, y + 14},
             fmt::format("{}, {}, in {}", quantity.title, band_title(*of_band), unit.name),
             {.size = 15, .anchor = Anchor::kMiddle});
    for (const MapPanel& p : panels) {
      if (p.line != line) continue;
      const Point center{left + pitch * (static_cast<double>(p.column) + 0.5), y + radius + 54};
      const Disk disk(center, radius, rim_zenith_deg);
      draw_surface(svg, disk, p.surface, p.field->samples, scale);
      draw_graticule(svg, disk, rim_zenith_deg, columns == 1);
      for (const auto& v : p.field->signature) {
        svg.circle(disk.at(v.aspect_azimuth_deg, v.aspect_elevation_deg), radius > 200 ? 1.6 : 1,
                   "#ffffff", {"#000000", 0.4, ""});
      }
      svg.text({center.x - radius - 8, center.y - radius + 2},
               names.name(p.field->signature.front()), {.size = 14, .bold = true});
    }
    draw_color_bar(svg, {900 - right + 18, y + 54}, 2 * radius, scale);
  }
  svg.text({450, svg.height_px() - 16},
           "Aspects seen from above the target, starboard to the right; equal-area, zenith in the "
           "centre, rings at elevations 60\u00b0, 30\u00b0. Dots: viewpoints.",
           {.size = 12, .anchor = Anchor::kMiddle, .color = "#555555"});
  return svg.finish();
}

}  // namespace irsig
