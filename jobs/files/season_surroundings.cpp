#include "jobs/files/season_surroundings.h"

namespace irsig {

using schema::Surroundings;

bool states_sky(const Surroundings& s) {
  return s.has_sky_temperature_k() || s.has_sky_radiance_w_m2_sr_um();
}

// The two ways to state the sky are one field; what the other kind of surroundings, or another sea,
// would need is not inherited.
Surroundings overridden(Surroundings base, const Surroundings& season) {
  if (states_sky(season)) {
    base.clear_sky_temperature_k();
    base.clear_sky_radiance_w_m2_sr_um();
  }
  if (season.has_kind() && season.kind() != base.kind()) {
    base.clear_solar_albedo();
    if (season.kind() != "none") base.clear_lower_radiance_w_m2_sr_um();
    if (season.kind() != "sea") {
      base.clear_sea_model();
      base.clear_sea_temperature_k();
      base.clear_sea_emissivity();
    }
    if (season.kind() != "ground") {
      base.clear_ground_temperature_k();
      base.clear_ground_emissivity();
    }
  }
  if (season.has_sea_model() && season.sea_model() != "grey") base.clear_sea_emissivity();
  base.MergeFrom(season);
  return base;
}

}  // namespace irsig
