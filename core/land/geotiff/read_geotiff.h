#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/land/height_raster.h"

namespace irsig {

// Reads the heights of a GeoTIFF: one band of integers or floats, strips or tiles, any compression
// of libtiff. The place is taken from ModelPixelScale (33550) and ModelTiepoint (33922), or from
// ModelTransformation (34264); the system from GeoKeyDirectory (34735); the value of missing
// heights from GDAL_NODATA (42113). INVALID_ARGUMENT, without the file's name: reason and remedy,
// for rotated rasters, systems other than EPSG 4326 and UTM on WGS 84, several bands, more samples
// than kMostLandVertices, and damage.                                       [OGC 19-008r4,
// GeoTIFF 1.1]
[[nodiscard]] absl::StatusOr<HeightRaster> read_geotiff(const std::string& file);

}  // namespace irsig
