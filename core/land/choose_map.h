#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "core/land/height_field.h"
#include "core/land/place_heights.h"

namespace irsig {

// Properties that a user may state of a map. The rest follows from its raster.
struct MapChoice {
  GeodeticPosition origin;
  double geoid_m = 0;
  std::optional<double> fill_m = std::nullopt;
  std::optional<double> spacing_m = std::nullopt;  // of vertices; default: the raster's
  std::optional<double> width_m =
      std::nullopt;  // of a square around the origin; default: all of the raster
};

// Returns the distance of a raster's samples: the shorter one of its two steps; of degrees, the one
// from south to north. [m]
[[nodiscard]] double spacing_of(const HeightRaster& raster);

// Returns a map whose vertices all have heights in the raster: a rectangle in the local frame of
// the origin, around the raster's middle. Rasters of degrees and of UTM are turned against that
// frame, so their outermost samples may lie outside the map. A map of a stated width reaches beyond
// the raster if fill_m is stated. Vertices on a raster of local metres are its samples if they have
// its spacing.
// INVALID_ARGUMENT: a raster without the origin, or without any height; a stated width beyond it.
[[nodiscard]] absl::StatusOr<LandMap> choose_map(const HeightRaster& raster,
                                                 const MapChoice& choice);

// Returns the map of an inset: the cells of the map around it that the raster covers as a whole,
// each divided into as many cells as comes nearest to the raster's spacing. INVALID_ARGUMENT: the
// raster covers no cell.
[[nodiscard]] absl::StatusOr<LandMap> choose_inset(const HeightRaster& raster,
                                                   const MapChoice& choice,
                                                   const HeightGrid& outer);

}  // namespace irsig
