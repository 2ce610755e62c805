#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/imported/imported_path.h"
#include "core/geo/frames.h"

namespace irsig {

// The surface below the horizon.
struct SurfaceBoundary {
  enum class Kind {
    kRoughSea,  // facets with Cox and Munk's slopes for the wind: emission, reflected sky
    kFlatSea,   // a mirror of water; the sun in it is left out
    kGreySea,   // emissivity, diffuse
    kGround     // emissivity, diffuse; the target stands on it as on the sea
  } kind = Kind::kRoughSea;
  double temperature_k = 0;
  double emissivity = 1;      // kGreySea, kGround
  double wind_speed_m_s = 0;  // kRoughSea
};

// Lowest height above sea or ground of the point that stands for a target in the air. [m]
inline constexpr double kLowestAirPointM = 1;

// One season's weather: the part of a condition that does not depend on the sun.
struct WeatherSpec {
  AtmosphereSpec air;  // its profile already bent to the surface
  bool refraction = true;
  SurfaceBoundary lower;
  // Somebody else's transmittance and path radiance instead of the embedded model's; null: none.
  std::shared_ptr<const ImportedPaths> imported;
  // Height of the target's reference point above sea or ground; it then stands for the target, from
  // kLowestAirPointM on. 0: the target stands on the surface (Environment::make). [m]
  double above_surface_m = 0;
  // [0, 1] Fraction of the sky that `cloud` covers. All light is the mean of that of a clear and of
  // an overcast sky with these weights; which of both a target has is part of the models' errors.
  double cloud_cover = 0;
  std::optional<CloudSpec> cloud = std::nullopt;  // required if anything is covered
  // Lowest and highest base that the cloud may have, where its own is not known: part of the
  // models' errors. [m above the surface]
  std::optional<std::array<double, 2>> cloud_base_range_m = std::nullopt;
  // Temperatures of these bases; absent: the profile's.  [K]
  std::optional<std::array<double, 2>> cloud_base_range_k = std::nullopt;
  // Least and largest water path that the cloud may have, as multiples of its own, where its own
  // is not known: part of the models' errors.
  std::optional<std::array<double, 2>> cloud_water_range = std::nullopt;
};

// The air, sky and sea of one condition of a sweep.
struct ConditionEnvironment {
  std::uint32_t weather = 0;  // index
  bool sun = false;           // whether it is to shine; what of it has set gives nothing
  Vec<Body> sun_direction;    // unit vector, airless
  double sun_distance_au = 1;
};

}  // namespace irsig
