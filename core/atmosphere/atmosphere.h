#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/absorber_amounts.h"
#include "core/atmosphere/aerosol.h"
#include "core/atmosphere/air_profile.h"
#include "core/atmosphere/cloud.h"
#include "core/atmosphere/light_path.h"

namespace irsig {

struct AtmosphereSpec {
  AirProfile profile;  // as bend_to_surface leaves it, if there is surface weather
  AerosolSpec aerosol;
  double co2_ppmv = 425;  // mean of 2024, replaces the profile's     [noaa_gml_co2]
  double cfc11_ppmv = 0.000216, cfc12_ppmv = 0.000485;
  // A layer that covers all of the sky; the air inside is saturated.
  std::optional<CloudSpec> cloud = std::nullopt;
  ForwardPeak forward_peak = ForwardPeak::kBeam;  // of cloud and fog
};

// The sun as seen from the surface below a path's first node.
struct SunPlace {
  double zenith_deg;   // without refraction
  double azimuth_deg;  // from the path's own azimuth: 0 when the path leads towards the sun
  double distance_au = 1;
};

// The effect of a path on the radiance behind it, L = T L_behind + thermal + scattered, and the
// path's own transmittance and radiance.
struct PathRadiance {
  AirSpectrum transmittance;
  AirSpectrum thermal_w_m2_sr_um;
  AirSpectrum scattered_w_m2_sr_um;  // sunlight scattered once, and surroundings_w_m2_sr_um
  AirSpectrum total_w_m2_sr_um;      // the sum of both

  // One sigma of the model (gas table, aerosol, one order of scattering), not of the numerics.
  AirSpectrum model_error_transmittance;
  AirSpectrum model_error_w_m2_sr_um;

  // Largest over the bands of 8-12 and 3-5 um, 0 where light that is scattered more than once is
  // computed. Above 0.3 such light counts: the model error then holds all of it.
  double scattering_optical_depth = 0;
  [[nodiscard]] bool beyond_single_scattering() const { return scattering_optical_depth > 0.3; }
};

struct PathLight {
  std::optional<SunPlace> sun;
  // Mean radiance over all directions of what is around the path, scattered into it; empty: none.
  AirSpectrum surroundings_w_m2_sr_um;
};

// The air of one condition. Immutable; all methods may be called from several threads.
class Atmosphere {
 public:
  [[nodiscard]] static absl::StatusOr<Atmosphere> make(AtmosphereSpec spec);

  [[nodiscard]] const AtmosphereSpec& spec() const { return spec_; }
  // With the levels of cloud and fog.
  [[nodiscard]] const AirProfile& profile() const { return spec_.profile; }
  [[nodiscard]] double surface_humidity_percent() const { return surface_humidity_percent_; }
  // Optical depths of the cloud, and the heights of its levels; empty without one.
  [[nodiscard]] const CloudOptics& cloud() const { return cloud_; }
  [[nodiscard]] const std::vector<double>& cloud_levels_m() const { return cloud_levels_m_; }
  // Heights of the levels of the air that scatters light more than once, increasing: that of the
  // cloud, of fog, or of both and what lies between them. Empty in clear air.
  [[nodiscard]] const std::vector<double>& turbid_levels_m() const { return turbid_levels_m_; }
  // Returns true if fog is all that scatters light more than once.
  [[nodiscard]] bool only_fog() const { return is_fog(spec_.aerosol.kind) && !spec_.cloud; }

  // Returns the absorbers in the path, 0 in bands that are not wanted. Amounts of pieces add up to
  // the amounts of the whole, to 2e-4 of transmittance.
  [[nodiscard]] AbsorberAmounts amounts(const LightPath& path,
                                        const BandChoice& bands = BandChoice()) const;

  // Amounts of the sun's path to a height, from `sun`'s zenith angle there; nullopt if the Earth is
  // in the way.
  [[nodiscard]] std::optional<AbsorberAmounts> sun_amounts(
      double height_m, double zenith_deg, const BandChoice& bands = BandChoice()) const;

  // Computes radiance and transmittance at the observer.
  //   L = sum over steps of (T_(l+1) - T_l) B(T_air), B linear in optical depth inside a step, by
  //       absorption only, + sun: sum of E0 T(u_l + u_sun) P(angle) x scattering depth
  //       (Henyey-Greenstein with the tabulated asymmetry; Rayleigh's for molecules).
  // `near`: if given, air between the observer and the path's first node: radiance (but not the
  // transmittance) is what arrives behind it, by summed amounts.
  [[nodiscard]] PathRadiance radiance(const LightPath& path, const PathLight& light = {},
                                      const AbsorberAmounts* near = nullptr) const;

  // Computes the sky from a height in a direction, or, below the horizon, the air in front of the
  // surface.
  [[nodiscard]] PathRadiance sky_radiance(double height_m, double zenith_deg,
                                          const PathLight& light = {},
                                          const AbsorberAmounts* near = nullptr) const;

  // Computes direct sunlight on a plane normal to the beam, at a height; 0 if the Earth is in the
  // way. [W m^-2 um^-1]
  //   near  further air before the light is seen (a reflection's way to the sensor), by summed
  //         amounts
  [[nodiscard]] AirSpectrum sun_irradiance_w_m2_um(double height_m, const SunPlace& sun,
                                                   const AbsorberAmounts* near = nullptr) const;

  // Computes the downward irradiance of the sky on a horizontal plane, without the sun's disk:
  // Gauss-Legendre over `zeniths` cosines, and 16 azimuths. [W m^-2 um^-1]
  [[nodiscard]] AirSpectrum sky_irradiance_w_m2_um(double height_m, const PathLight& light = {},
                                                   int zeniths = 8) const;

 private:
  explicit Atmosphere(AtmosphereSpec spec);

  AtmosphereSpec spec_;
  double surface_humidity_percent_;
  CloudOptics cloud_;
  std::vector<double> cloud_levels_m_, turbid_levels_m_;
};

}  // namespace irsig
