#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/land/height_raster.h"

namespace irsig {

// A square piece of made-up land, centred on the origin of its local frame.
struct Terrain {
  std::uint64_t seed = 0;
  double width_m = 10000;  // [100, 400000]
  double spacing_m = 30;   // of samples, >= 0.1
  double relief_m = 200;   // height of the highest hills above their valleys, [0, 5000]
};

// Layers of a terrain: "heights" [m], and the fraction of each sample's square that a material
// covers: "asphalt", "bare_soil", "grass", "water", "wheat".
[[nodiscard]] const std::vector<std::string_view>& terrain_layers();

// Returns one layer of a terrain. The same seed and relief give the same land, whatever the width
// and spacing. The fractions of a sample add up to 1, in steps of 1/16.
//
// Hills are value noise of 8 octaves, from 6 km to 47 m. A river 40 m wide falls by 0.5 m a
// kilometre from west to east; a road 7 m wide runs from south to north and ends at the river.
// Fields are 240 m x 120 m. INVALID_ARGUMENT: values beyond the ranges above, more than 1e8
// samples.
[[nodiscard]] absl::StatusOr<HeightRaster> generate_terrain(const Terrain& terrain,
                                                            std::string_view layer);

}  // namespace irsig
