#include "core/environment/surroundings.h"

#include <algorithm>
#include <numbers>

#include "core/spectral/planck.h"

namespace irsig {

double sky_radiance_w_m2_sr_um(const Surroundings& s, double lambda_um) {
  return s.sky_temperature_k >= 0 ? planck_radiance_w_m2_sr_um(lambda_um, s.sky_temperature_k)
                                  : s.sky_radiance_w_m2_sr_um;
}

double lower_radiance_w_m2_sr_um(const Surroundings& s, double lambda_um,
                                 double sun_irradiance_w_m2_um, double cos_sun_zenith) {
  if (s.kind == SurroundingsKind::kNone) return s.lower_radiance_w_m2_sr_um;
  const double sun = sun_irradiance_w_m2_um * std::max(0.0, cos_sun_zenith) / std::numbers::pi;
  return s.sea_emissivity * planck_radiance_w_m2_sr_um(lambda_um, s.sea_temperature_k) +
         (1 - s.sea_emissivity) * (sky_radiance_w_m2_sr_um(s, lambda_um) + sun);
}

}  // namespace irsig
