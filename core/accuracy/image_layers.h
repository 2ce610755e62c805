#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace irsig {

// Further images of a row beside the target's radiance. Those of light add up:
// emitted + sun + sky + surface + parts + gas_emitted - gas_absorbed is the image. With at_sensor
// they are what arrives at the sensor, and
//   at_sensor = emitted + sun + sky + surface + parts + path + background - hidden
//               + gas_emitted - gas_absorbed
// path + background is what the sensor sees without target and hot gas. All layers but the gas's
// own are those of light that no hot gas has absorbed.
// Land that a pixel shows has its part in it: land_emitted + land_sky + land_sun is what arrives of
// its light, without the light of the air before it.
// Layers from kTemperature to kSunlit are means over what a pixel shows of the target, 0 where it
// shows none; kLandTemperature is one over the land that it would show without the target. Normals
// are in the body frame (x forward, y starboard, z down), on the side of the sensor.
enum class ImageLayer : std::uint8_t {
  kEmitted,
  kSun,
  kSky,
  kSurface,
  kParts,
  kPath,
  kBackground,
  kHidden,
  kAtSensor,
  kGasEmitted,
  kGasAbsorbed,
  kLandEmitted,
  kLandSky,
  kLandSun,
  kWithoutAir,
  kTemperature,
  kRange,
  kNormalX,
  kNormalY,
  kNormalZ,
  kSunlit,
  kLandTemperature
};

struct ImageLayerInfo {
  const char *name, *unit, *what;
};
inline constexpr std::array<ImageLayerInfo, 22> kImageLayers = {{
    {"emitted", "W/(m2 sr)", "light that the target emits"},
    {"sun", "W/(m2 sr)", "direct sunlight that it reflects"},
    {"sky", "W/(m2 sr)", "light of the sky that it reflects"},
    {"surface", "W/(m2 sr)", "light of sea or ground that it reflects"},
    {"parts", "W/(m2 sr)", "light of its own parts that it reflects"},
    {"path", "W/(m2 sr)", "light of the air between target and sensor"},
    {"background", "W/(m2 sr)",
     "light of what stands behind and beside the target, without that of the path"},
    {"hidden", "W/(m2 sr)", "of the background what the target hides"},
    {"at_sensor", "W/(m2 sr)", "all that the sensor sees"},
    {"gas_emitted", "W/(m2 sr)", "light that hot gas emits"},
    {"gas_absorbed", "W/(m2 sr)", "light of what is behind hot gas that the gas absorbs"},
    {"land_emitted", "W/(m2 sr)", "light that land emits which a pixel shows"},
    {"land_sky", "W/(m2 sr)", "light of the sky that this land reflects"},
    {"land_sun", "W/(m2 sr)", "direct sunlight that this land reflects"},
    {"without_air", "W/(m2 sr)",
     "light that target and land emit, without the air before them; and sky"},
    {"temperature", "K", "mean over what a pixel shows of the target; 0 where it shows none"},
    {"range", "m", "distance from the sensor, likewise"},
    {"normal_x", "1", "mean unit normal of the facets that a pixel shows, forward"},
    {"normal_y", "1", "mean unit normal of the facets that a pixel shows, starboard"},
    {"normal_z", "1", "mean unit normal of the facets that a pixel shows, down"},
    {"sunlit", "1", "fraction in direct sun of what a pixel shows of the target"},
    {"land_temperature", "K",
     "mean over the land that a pixel shows beside or behind the target; 0 where there is none"},
}};
[[nodiscard]] constexpr const char* name_of(ImageLayer layer) {
  return kImageLayers[static_cast<std::size_t>(layer)].name;
}
// Returns true if a layer is a mean over what a pixel shows of the target.
[[nodiscard]] constexpr bool is_mean_of_target(ImageLayer layer) {
  return layer >= ImageLayer::kTemperature && layer <= ImageLayer::kSunlit;
}
// Returns true if a layer needs hot gas.
[[nodiscard]] constexpr bool is_of_gas(ImageLayer layer) {
  return layer == ImageLayer::kGasEmitted || layer == ImageLayer::kGasAbsorbed;
}
// Returns true if a layer needs land.
[[nodiscard]] constexpr bool is_of_land(ImageLayer layer) {
  return (layer >= ImageLayer::kLandEmitted && layer <= ImageLayer::kWithoutAir) ||
         layer == ImageLayer::kLandTemperature;
}
[[nodiscard]] constexpr bool is_radiance(ImageLayer layer) {
  return layer < ImageLayer::kTemperature;
}
// Returns true if a layer is a sum over paths, which has a standard error in each pixel. The others
// are integrals, means over the samples that meet the target, or no light of the target's paths.
[[nodiscard]] constexpr bool has_standard_error(ImageLayer layer) {
  return layer <= ImageLayer::kParts || layer == ImageLayer::kHidden ||
         layer == ImageLayer::kAtSensor || is_of_gas(layer);
}
[[nodiscard]] constexpr std::optional<ImageLayer> image_layer_of(std::string_view name) {
  for (std::size_t i = 0; i < kImageLayers.size(); ++i)
    if (kImageLayers[i].name == name) return static_cast<ImageLayer>(i);
  return std::nullopt;
}

}  // namespace irsig
