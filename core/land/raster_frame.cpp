#include "core/land/raster_frame.h"

#include <cmath>

namespace irsig {
namespace {

bool same_system(const MapSystem& a, const MapSystem& b) {
  const UtmZone *zone_a = std::get_if<UtmZone>(&a), *zone_b = std::get_if<UtmZone>(&b);
  if (zone_a == nullptr || zone_b == nullptr) return a.index() == b.index();
  return zone_a->zone == zone_b->zone && zone_a->south == zone_b->south;
}

}  // namespace

RasterFrame::RasterFrame(const HeightRaster& raster, const GeodeticPosition& origin)
    : system_(raster.system),
      x0_(raster.x0),
      y0_(raster.y0),
      x_step_(raster.x_step),
      y_step_(raster.y_step),
      columns_(raster.columns),
      rows_(raster.rows),
      longitude_deg_(origin.longitude_deg) {
  const double middle = raster.x0 + 0.5 * (raster.columns - 1) * raster.x_step;
  // The origin's longitude is taken within 180 degrees of the raster's middle.
  raster_longitude_deg_ = middle + std::remainder(origin.longitude_deg - middle, 360.0);
}

RasterPlace RasterFrame::place(double x_m, double y_m, const GeodeticPosition& at) const {
  double x = x_m, y = y_m;
  if (std::holds_alternative<GeographicDegrees>(system_)) {
    x = raster_longitude_deg_ + std::remainder(at.longitude_deg - longitude_deg_, 360.0);
    y = at.latitude_deg;
  } else if (const UtmZone* zone = std::get_if<UtmZone>(&system_)) {
    const UtmPoint point = utm_point(*zone, at.latitude_deg, at.longitude_deg);
    x = point.easting_m;
    y = point.northing_m;
  }
  return {(x - x0_) / x_step_, (y - y0_) / y_step_};
}

bool RasterFrame::same_grid(const HeightRaster& other) const {
  return same_system(system_, other.system) && x0_ == other.x0 && y0_ == other.y0 &&
         x_step_ == other.x_step && y_step_ == other.y_step && columns_ == other.columns &&
         rows_ == other.rows;
}

}  // namespace irsig
