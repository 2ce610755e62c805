#pragma once

namespace irsig {

// A sweep file on land whose grass and asphalt are computed: nothing is stated of them but what
// they are.
inline constexpr const char* kHeatedLand = R"(time = ["06:00Z", "12:00Z"]
[model]
generate = "box"
triangles = 64
[place]
latitude_deg = 48
longitude_deg = 11
heading_deg = 90
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
solar_absorptance = 0.7
[[part]]
name = "box"
material = "paint"
temperature_k = 300
[heat]
step_minutes = 60
[[season]]
name = "summer"
date = 2025-06-21
air_temperature_k = 290
relative_humidity_percent = 50
pressure_pa = 101300
wind_speed_m_s = 3
wind_from_deg = 200
[[season]]
name = "winter"
date = 2025-12-21
air_temperature_k = 275
relative_humidity_percent = 70
pressure_pa = 101300
wind_speed_m_s = 3
wind_from_deg = 200
land_temperature_k = { asphalt = 274 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 1
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 0, elevation_deg = 20 } ]
[surroundings]
kind = "ground"
ground_temperature_k = 290
ground_emissivity = 0.95
solar_albedo = 0.2
[air]
model = "atmosphere"
aerosol = "rural"
visibility_m = 23000
[transport]
sun = true
[land]
heights = "heights.asc"
geoid_m = 0
[[land.material]]
material = "asphalt"
fraction_file = "asphalt.asc"
[[land.material]]
material = "grass"
)";

}  // namespace irsig
