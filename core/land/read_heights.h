#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/land/height_raster.h"

namespace irsig {

// Reads the heights of a file by the end of its name: .hgt, .asc, .tif or .tiff. `system` states
// the coordinates of an .asc file (nullopt: the land's local metres); the others state their own.
// GeoTIFF is read by irsig-heights, a process of its own with limits, because a small file may ask
// for gigabytes and libtiff may crash on a damaged one. INVALID_ARGUMENT: "file: reason; remedy",
// with line and column for .asc. INTERNAL: irsig-heights could not be run. May be called from
// several threads at once.
[[nodiscard]] absl::StatusOr<HeightRaster> read_heights(
    std::string_view bytes, const std::string& file,
    const std::optional<MapSystem>& system = std::nullopt);

// Encodes one side of the exchange with irsig-heights; decode_raster() reads it. DATA_LOSS: the
// bytes differ from those of encode_raster. INVALID_ARGUMENT: the error that encode_raster was
// given.
[[nodiscard]] std::string encode_raster(const absl::StatusOr<HeightRaster>& raster);
[[nodiscard]] absl::StatusOr<HeightRaster> decode_raster(std::string_view bytes);

}  // namespace irsig
