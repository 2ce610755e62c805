#pragma once

namespace irsig {

enum class SurroundingsKind { kSea, kGround, kNone };

// Surroundings of the target, uniform over each hemisphere.
//   kSea, kGround:  sky above the horizon; below it a grey, diffuse, unshadowed surface at z = 0,
//                    which is a sea's if suns may be mirrored by it
//   kNone:          two stated radiances; no surface and no Earth.
struct Surroundings {
  SurroundingsKind kind = SurroundingsKind::kNone;
  double sky_temperature_k = -1;                     // >= 0: a blackbody sky
  double sky_radiance_w_m2_sr_um = 0;                // used if sky_temperature_k < 0
  double sea_temperature_k = 0, sea_emissivity = 1;  // of sea or ground
  double lower_radiance_w_m2_sr_um = 0;              // kNone
};

// Returns the radiance from above the horizon. [W m^-2 sr^-1 um^-1]
[[nodiscard]] double sky_radiance_w_m2_sr_um(const Surroundings& s, double lambda_um);

// Returns the radiance from below the horizon:                            [W m^-2 sr^-1 um^-1]
//   surface: eps B(T_sea) + (1 - eps) (L_sky + E_sun cos(sun zenith) / pi)
//   sun_irradiance_w_m2_um: normal to the beam; 0 when the sun is below the horizon.
[[nodiscard]] double lower_radiance_w_m2_sr_um(const Surroundings& s, double lambda_um,
                                               double sun_irradiance_w_m2_um,
                                               double cos_sun_zenith);

}  // namespace irsig
