#pragma once

#include <vector>

#include "core/environment/line_horizon.h"
#include "core/environment/sensor_path.h"
#include "core/environment/weather_bounds.h"

namespace irsig {

// Upper bounds of one condition's sunlight at the target, on the air's bands. Private to
// core/environment, as all of this header.
struct ConditionBounds {
  ConditionBounds(const ConditionEnvironment& condition, const SunSeen& seen,
                  const WeatherBounds& weather);

  const WeatherBounds& weather;
  bool shines = false, scatters = false;  // on the target, in the air around it
  Vec<Body> direction;
  AirSpectrum outside, sun, diffuse_sun, diffuse_sun_w_m2_um, mirrored_sun, mirrored_sun_w_m2_um;
  AirSpectrum lower_sun;               // of diffuse_sun, below the horizon
  std::vector<AirSpectrum> sun_above;  // [WeatherBounds::above]: irradiance from there down

 private:
  void scatter(double slant);
  void mirror();
};

[[nodiscard]] LightBounds light_bounds(const ConditionBounds& condition, const SensorPath& leg,
                                       const SensorLine& line, const LineHorizon& horizon);

}  // namespace irsig
