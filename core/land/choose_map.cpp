#include "core/land/choose_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geo/map_coordinates.h"
#include "core/land/raster_frame.h"

namespace irsig {
namespace {

constexpr double kMetresOfDegree = 111195;  // of latitude, on a sphere of 6371 km
constexpr double kRounding = 1e-9;          // of numbers of cells

struct Rectangle {
  double west_m, south_m, east_m, north_m;
  [[nodiscard]] double area() const { return (east_m - west_m) * (north_m - south_m); }
};

struct HeightsOf {
  double lowest_m = std::numeric_limits<double>::infinity(), highest_m = -lowest_m;
};
HeightsOf heights_of(const HeightRaster& raster) {
  HeightsOf out;
  for (const float height : raster.height_m) {
    if (std::isnan(height)) continue;
    out.lowest_m = std::min(out.lowest_m, double(height));
    out.highest_m = std::max(out.highest_m, double(height));
  }
  return out;
}

// A raster over the local frame of an origin.
class RasterOutline {
 public:
  RasterOutline(const HeightRaster& raster, const MapChoice& choice)
      : raster_(raster), origin_(choice.origin), frame_(raster, choice.origin) {
    const HeightsOf heights = heights_of(raster);
    z_m_ = {heights.lowest_m + choice.geoid_m - origin_.height_m,
            heights.highest_m + choice.geoid_m - origin_.height_m};
    // place_heights() interpolates between places that are exact, to 2.5 mm.
    margin_ = std::max(1e-3, 0.005 / spacing_of(raster));
  }

  [[nodiscard]] Rectangle rectangle() const {
    const double last_column = raster_.columns - 1.0, last_row = raster_.rows - 1.0;
    if (std::holds_alternative<LocalMetres>(raster_.system)) {
      const double x1 = raster_.x0 + last_column * raster_.x_step;
      const double y1 = raster_.y0 + last_row * raster_.y_step;
      return {std::min(raster_.x0, x1), std::min(raster_.y0, y1), std::max(raster_.x0, x1),
              std::max(raster_.y0, y1)};
    }
    const Vec<Enu> middle = point_at(last_column / 2, last_row / 2);
    const auto half = [&](Vec<Enu> a, Vec<Enu> b) {
      return std::min(length(a - middle), length(b - middle));
    };
    const double half_x = half(point_at(0, last_row / 2), point_at(last_column, last_row / 2));
    const double half_y = half(point_at(last_column / 2, 0), point_at(last_column / 2, last_row));
    // Grids are turned and bent against the local frame: sides become shorter until all is covered.
    Rectangle best{0, 0, 0, 0};
    for (const double along_x : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const auto shrunk = [&](double by) -> Rectangle {
        const double x_m = half_x * (1 - along_x * by), y_m = half_y * (1 - (1 - along_x) * by);
        return {middle.x - x_m, middle.y - y_m, middle.x + x_m, middle.y + y_m};
      };
      double low = 0, high = 1;
      if (covers(shrunk(0))) high = 0;
      for (int round = 0; round < 30 && high > 0; ++round) {
        const double by = 0.5 * (low + high);
        (covers(shrunk(by)) ? high : low) = by;
      }
      if (high < 1 && shrunk(high).area() > best.area()) best = shrunk(high);
    }
    return best;
  }

  // Returns true if the raster covers a rectangle at its lowest and at its highest height.
  [[nodiscard]] bool covers(const Rectangle& r) const {
    constexpr int kPoints = 32;  // of a side
    for (int i = 0; i <= kPoints; ++i) {
      const double u = i / double(kPoints);
      const double x_m = r.west_m + u * (r.east_m - r.west_m);
      const double y_m = r.south_m + u * (r.north_m - r.south_m);
      if (!holds(x_m, r.south_m) || !holds(x_m, r.north_m) || !holds(r.west_m, y_m) ||
          !holds(r.east_m, y_m))
        return false;
    }
    return true;
  }

  [[nodiscard]] RasterPlace place(double x_m, double y_m, double z_m) const {
    return frame_.place(x_m, y_m, geodetic_position(origin_, {x_m, y_m, z_m}));
  }

 private:
  [[nodiscard]] bool holds(double x_m, double y_m) const {
    const double margin = std::holds_alternative<LocalMetres>(raster_.system) ? -1e-6 : margin_;
    // The land lies below the plane z = 0 by the Earth's curvature.
    const double drop_m = (x_m * x_m + y_m * y_m) / (2 * 6371e3);
    return std::all_of(z_m_.begin(), z_m_.end(), [&](double z_m) {
      const RasterPlace at = place(x_m, y_m, z_m - drop_m);
      return at.column >= margin && at.column <= raster_.columns - 1 - margin && at.row >= margin &&
             at.row <= raster_.rows - 1 - margin;
    });
  }

  // The point of the local frame at a place of the raster, by Newton's method.
  [[nodiscard]] Vec<Enu> point_at(double column, double row) const {
    constexpr double kStepM = 10;
    Vec<Enu> point{};
    for (int round = 0; round < 20; ++round) {
      const RasterPlace here = place(point.x, point.y, 0);
      const RasterPlace east = place(point.x + kStepM, point.y, 0);
      const RasterPlace north = place(point.x, point.y + kStepM, 0);
      const double a = (east.column - here.column) / kStepM,
                   b = (north.column - here.column) / kStepM;
      const double c = (east.row - here.row) / kStepM, d = (north.row - here.row) / kStepM;
      const double u = column - here.column, v = row - here.row;
      const double determinant = a * d - b * c;
      if (determinant == 0) break;
      const double dx = (d * u - b * v) / determinant, dy = (a * v - c * u) / determinant;
      point.x = std::clamp(point.x + dx, -3e6, 3e6);
      point.y = std::clamp(point.y + dy, -3e6, 3e6);
      if (std::hypot(dx, dy) < 1e-6) break;
    }
    return point;
  }

  const HeightRaster& raster_;
  GeodeticPosition origin_;
  RasterFrame frame_;
  std::array<double, 2> z_m_{};
  double margin_ = 0;
};

std::uint32_t cells_of(double length_m, double spacing_m) {
  return static_cast<std::uint32_t>(
      std::clamp(std::floor(length_m / spacing_m + kRounding), 0.0, 4e9));
}

// A multiple of the spacing from `from_m`, the least one from `least_m` on.
double snapped_m(double least_m, double from_m, double spacing_m) {
  return from_m + std::ceil((least_m - from_m) / spacing_m - kRounding) * spacing_m;
}

absl::Status check(const HeightRaster& raster) {
  if (raster.columns < 2 || raster.rows < 2 ||
      raster.height_m.size() != std::size_t{raster.columns} * raster.rows)
    return absl::InvalidArgumentError("a raster needs at least 2 x 2 samples");
  if (!(heights_of(raster).lowest_m <= kMostHeightM))
    return absl::InvalidArgumentError("no sample has a height");
  // Metres of a grid, read as degrees.
  const double last_y = raster.y0 + raster.y_step * (raster.rows - 1);
  if (std::holds_alternative<GeographicDegrees>(raster.system) &&
      (std::abs(raster.y0) > 90.5 || std::abs(last_y) > 90.5 || std::abs(raster.x0) > 360.5))
    return absl::InvalidArgumentError(
        absl::StrCat("its coordinates begin at x = ", absl::SixDigits(raster.x0),
                     ", y = ", absl::SixDigits(raster.y0),
                     ", which are no degrees of longitude and latitude (EPSG 4326): state the "
                     "code of its UTM zone, or none where x and y are metres from the target"));
  return absl::OkStatus();
}

}  // namespace

double spacing_of(const HeightRaster& raster) {
  if (std::holds_alternative<GeographicDegrees>(raster.system))
    return std::abs(raster.y_step) * kMetresOfDegree;
  return std::min(std::abs(raster.x_step), std::abs(raster.y_step));
}

absl::StatusOr<LandMap> choose_map(const HeightRaster& raster, const MapChoice& choice) {
  RETURN_IF_ERROR(check(raster));
  const RasterOutline outline(raster, choice);
  LandMap map{.origin = choice.origin, .geoid_m = choice.geoid_m, .fill_m = choice.fill_m};
  map.spacing_m = choice.spacing_m.value_or(spacing_of(raster));
  const RasterPlace origin = outline.place(0, 0, 0);
  if (!choice.fill_m && !(origin.column >= 0 && origin.column <= raster.columns - 1 &&
                          origin.row >= 0 && origin.row <= raster.rows - 1))
    return absl::InvalidArgumentError(absl::StrCat(
        "the map does not contain the target's place (latitude ", choice.origin.latitude_deg,
        ", longitude ", choice.origin.longitude_deg, "): column ", absl::SixDigits(origin.column),
        ", row ", absl::SixDigits(origin.row), " of ", raster.columns, " x ", raster.rows,
        " samples; correct [place], or the coordinates' EPSG code, or use another map"));
  Rectangle covered = outline.rectangle();
  if (choice.width_m) {
    const double half_m = 0.5 * *choice.width_m;
    const Rectangle square{-half_m, -half_m, half_m, half_m};
    if (!choice.fill_m && !outline.covers(square))
      return absl::InvalidArgumentError(absl::StrCat(
          "the map does not cover a square of ", *choice.width_m,
          " m around the target; it covers x = ", absl::SixDigits(covered.west_m), " to ",
          absl::SixDigits(covered.east_m), " m and y = ", absl::SixDigits(covered.south_m), " to ",
          absl::SixDigits(covered.north_m), " m from the target"));
    covered = square;
  }
  map.west_m = covered.west_m;
  map.south_m = covered.south_m;
  // Samples of local metres stay vertices.
  if (std::holds_alternative<LocalMetres>(raster.system) &&
      std::abs(std::abs(raster.x_step) - map.spacing_m) <= kRounding * map.spacing_m) {
    map.west_m = snapped_m(covered.west_m, raster.x0, map.spacing_m);
    map.south_m = snapped_m(covered.south_m, raster.y0, map.spacing_m);
  }
  map.columns = cells_of(covered.east_m - map.west_m, map.spacing_m);
  map.rows = cells_of(covered.north_m - map.south_m, map.spacing_m);
  if (map.columns == 0 || map.rows == 0)
    return absl::InvalidArgumentError(absl::StrCat(
        "a map from x = ", absl::SixDigits(covered.west_m), " to ", absl::SixDigits(covered.east_m),
        " m and y = ", absl::SixDigits(covered.south_m), " to ", absl::SixDigits(covered.north_m),
        " m has no cell of ", map.spacing_m, " m; expected a smaller spacing"));
  return map;
}

absl::StatusOr<LandMap> choose_inset(const HeightRaster& raster, const MapChoice& choice,
                                     const HeightGrid& outer) {
  RETURN_IF_ERROR(check(raster));
  const Rectangle covered = RasterOutline(raster, choice).rectangle();
  const double spacing_m = outer.spacing_m;
  const auto first = [&](double edge_m, double from_m) {
    return std::max(0.0, std::ceil((edge_m - from_m) / spacing_m - kRounding));
  };
  const auto last = [&](double edge_m, double from_m, std::uint32_t cells) {
    return std::min<double>(cells, std::floor((edge_m - from_m) / spacing_m + kRounding));
  };
  const double west = first(covered.west_m, outer.west_m);
  const double east = last(covered.east_m, outer.west_m, outer.columns);
  const double south = first(covered.south_m, outer.south_m);
  const double north = last(covered.north_m, outer.south_m, outer.rows);
  if (!(east > west && north > south))
    return absl::InvalidArgumentError(absl::StrCat(
        "the inset from x = ", absl::SixDigits(covered.west_m), " to ",
        absl::SixDigits(covered.east_m), " m and y = ", absl::SixDigits(covered.south_m), " to ",
        absl::SixDigits(covered.north_m), " m covers no cell of the map around it, which has cells",
        " of ", spacing_m, " m; use an inset within that map"));
  const double fineness = std::max(1.0, std::round(spacing_m / spacing_of(raster)));
  return LandMap{.origin = choice.origin,
                 .west_m = outer.west_m + west * spacing_m,
                 .south_m = outer.south_m + south * spacing_m,
                 .spacing_m = spacing_m / fineness,
                 .columns = static_cast<std::uint32_t>((east - west) * fineness),
                 .rows = static_cast<std::uint32_t>((north - south) * fineness),
                 .geoid_m = choice.geoid_m,
                 .fill_m = choice.fill_m};
}

}  // namespace irsig
