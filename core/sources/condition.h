#pragma once

#include <memory>
#include <vector>

#include "core/environment/surroundings.h"
#include "core/geo/frames.h"
#include "core/sources/emission.h"

namespace irsig {

class PlumeField;

// One season at one time.
struct ConditionSpec {
  // Temperatures in the order of the scene's parts; where facets have temperatures of their own,
  // the hottest.
  std::vector<double> part_temperature_k;
  std::shared_ptr<const EmitterTemperatures> emitter = nullptr;  // null: parts have one each
  std::shared_ptr<const PlumeField> gas = nullptr;  // hot gas around the target; null: none
  Surroundings surroundings;
  bool sun = false;         // whether direct sun is part of this condition
  Vec<Body> sun_direction;  // unit vector towards the sun
  double sun_cos_zenith = 0;
  double sun_angular_radius_deg = 0;
  // Sine of the dip of the horizon that cuts the sun's disk, seen from the target.
  double sun_horizon_z = 0;
  double sun_scale = 0;     // irradiance at the target = sun_scale x E490 (1 AU, in vacuum)
  double sea_wind_m_s = 0;  // > 0: the sea mirrors the sun, as rough as this wind makes it
  double air_temperature_k = 0;
  // Height of the target's reference point above sea or ground. [m]
  double above_surface_m = 0;
  // [kind of LandScene::kinds, or material of LandScene::cover]
  std::vector<double> land_temperature_k = {};
  std::vector<double> land_temperature_error_k = {};  // likewise; empty: known
};

// Returns the sine of the depression of the horizon above a sphere without air, from such a height.
[[nodiscard]] double sine_of_dip(double height_m);

// Returns true if some of the sun's disk is above the horizon.
[[nodiscard]] bool sun_shines(const ConditionSpec& condition);

}  // namespace irsig
