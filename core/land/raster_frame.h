#pragma once

#include "core/geo/line_of_sight.h"
#include "core/land/height_raster.h"

namespace irsig {

// A place on a raster, in samples: (0, 0) is the first sample of the first row.
struct RasterPlace {
  double column = 0, row = 0;
};

// The grid of a raster seen from the local frame of an origin.
class RasterFrame {
 public:
  RasterFrame(const HeightRaster& raster, const GeodeticPosition& origin);

  // Returns where the raster has the point (x_m, y_m) of the local frame, whose geodetic position
  // is `at`. Accuracy: that of utm_point(); of local metres and degrees, rounding.
  [[nodiscard]] RasterPlace place(double x_m, double y_m, const GeodeticPosition& at) const;

  // Returns true if each sample of the other raster lies at the place of the same sample of this.
  [[nodiscard]] bool same_grid(const HeightRaster& other) const;

  [[nodiscard]] std::uint32_t columns() const { return columns_; }
  [[nodiscard]] std::uint32_t rows() const { return rows_; }

 private:
  MapSystem system_;
  double x0_, y0_, x_step_, y_step_;
  std::uint32_t columns_, rows_;
  double longitude_deg_;         // of the origin
  double raster_longitude_deg_;  // the same, as the raster counts its turns
};

}  // namespace irsig
