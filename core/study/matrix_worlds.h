#pragma once

#include <array>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/simulator.h"

namespace irsig {

// Weather, light and materials of the matrix of effects (effects_matrix.h).

[[nodiscard]] Band mid_wave_band();   // 3-5 um
[[nodiscard]] Band long_wave_band();  // 8-12 um

[[nodiscard]] MaterialSpec matt_paint(double emissivity);  // Lambert, the same at all wavelengths
// Returns the library's aluminium, with another roughness if that is > 0.
[[nodiscard]] absl::StatusOr<MaterialSpec> bare_aluminium(double roughness = 0);

// Returns a summer's day of 23 km visibility: a sea of 288 K under a wind of 5 m/s, or land of 290
// K with an emissivity of 0.95.
[[nodiscard]] WeatherSpec open_sea();
[[nodiscard]] WeatherSpec bare_land();
[[nodiscard]] WeatherSpec sea_fog(double visibility_m);

// Returns a condition without sun.
[[nodiscard]] ConditionSpec condition_over(const WeatherSpec& weather,
                                           std::vector<double> part_temperature_k);
void add_sun(ConditionSpec& condition, double azimuth_deg, double elevation_deg);  // as an aspect
void add_sun(ConditionSpec& condition, Vec<Body> direction);

// Returns viewpoints from an azimuth and an elevation each.
[[nodiscard]] std::vector<Viewpoint> grid_of(const std::vector<std::array<double, 2>>& aspect_deg,
                                             double range_m);

}  // namespace irsig
