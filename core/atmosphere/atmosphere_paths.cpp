// Amounts and light of paths through an atmosphere.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/gas_table.h"
#include "core/atmosphere/path_layers.h"
#include "core/atmosphere/path_sums.h"
#include "core/spectral/solar.h"

namespace irsig {

namespace {

double grey_depth(const AbsorberAmounts& amounts, std::size_t band) {
  double sum = 0;
  for (const AirSpectrum& depth : amounts.optical_depth) sum += depth[band];
  return sum;
}

// Takes the forward peak of scattered light into the beam, as cloud_optics() does.
void take_forward_peak(AerosolOptics& optics, const BandChoice& bands) {
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t band = r.first; band < r.last; ++band) {
      double& g = optics.asymmetry[band];
      optics.scattering_per_m[band] *= 1 - g * g;
      g /= 1 + g;
    }
  }
}

void add_aerosol(AbsorberAmounts& out, StepScattering* scattering, const AtmosphereSpec& spec,
                 double surface_humidity_percent, const LightPath& path, std::size_t step,
                 const BandChoice& bands) {
  const LightPath::Node &a = path.node[step], &b = path.node[step + 1];
  const double length_m = path.step_m[step];
  const AirProfile& profile = spec.profile;
  if (spec.aerosol.kind == AerosolKind::kNone) return;

  // Gauss's two points; one where the optics hardly vary along the step.
  const double rise_m = b.height_m - a.height_m;
  const bool level = std::abs(rise_m) < 10;
  const double offset = level ? 0 : 0.28867513459481287;
  AirSpectrum& absorption =
      out.optical_depth[static_cast<std::size_t>(GreyAbsorber::kAerosolAbsorption)];
  AirSpectrum& scatter =
      out.optical_depth[static_cast<std::size_t>(GreyAbsorber::kAerosolScattering)];
  for (int i = 0; i < (level ? 1 : 2); ++i) {
    const double height_m = a.height_m + (0.5 + (2 * i - 1) * offset) * rise_m;
    const bool fog = is_fog(spec.aerosol.kind) && height_m < kFogTopM;
    AerosolOptics optics =
        aerosol_optics(spec.aerosol, height_m, relative_humidity_percent(air_at(profile, height_m)),
                       surface_humidity_percent, bands);
    if (fog && spec.forward_peak == ForwardPeak::kDiffuse) take_forward_peak(optics, bands);
    const double share_m = level ? length_m : 0.5 * length_m;
    for (const BandChoice::Range& r : bands.ranges()) {
      for (std::size_t band = r.first; band < r.last; ++band) {
        absorption[band] += share_m * optics.absorption_per_m[band];
        const double depth = share_m * optics.scattering_per_m[band];
        scatter[band] += depth;
        if (!scattering) continue;
        if (fog) {
          add_scattering(scattering->cloud_depth[band], scattering->cloud_asymmetry[band], depth,
                         optics.asymmetry[band]);
        } else {
          add_scattering(scattering->aerosol_depth[band], scattering->asymmetry[band], depth,
                         optics.asymmetry[band]);
        }
      }
    }
  }
}

// The part of a step's length that lies in the cloud, as a multiple of the cloud's thickness.
double cloud_share(const Atmosphere& atmosphere, const LightPath& path, std::size_t step) {
  if (atmosphere.cloud_levels_m().empty()) return 0;
  const double base_m = atmosphere.cloud_levels_m().front(),
               top_m = atmosphere.cloud_levels_m().back();
  const auto [low_m, high_m] = std::minmax(path.node[step].height_m, path.node[step + 1].height_m);
  constexpr double kLevelM = 1e-6;
  double inside = 0;
  if (high_m - low_m < kLevelM) {
    inside = low_m >= base_m && high_m <= top_m ? 1 : 0;
  } else {
    inside = std::max(0.0, std::min(high_m, top_m) - std::max(low_m, base_m)) / (high_m - low_m);
  }
  return inside * path.step_m[step] / (top_m - base_m);
}

void add_cloud(AbsorberAmounts& out, StepScattering* scattering, const Atmosphere& atmosphere,
               const LightPath& path, std::size_t step, const BandChoice& bands) {
  if (atmosphere.cloud_levels_m().empty()) return;
  const double share = cloud_share(atmosphere, path, step);
  const CloudOptics& cloud = atmosphere.cloud();
  if (share <= 0) return;
  AirSpectrum& absorption =
      out.optical_depth[static_cast<std::size_t>(GreyAbsorber::kAerosolAbsorption)];
  AirSpectrum& scatter =
      out.optical_depth[static_cast<std::size_t>(GreyAbsorber::kAerosolScattering)];
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t band = r.first; band < r.last; ++band) {
      absorption[band] += share * cloud.absorption[band];
      scatter[band] += share * cloud.scattering[band];
      if (scattering) {
        add_scattering(scattering->cloud_depth[band], scattering->cloud_asymmetry[band],
                       share * cloud.scattering[band], cloud.asymmetry[band]);
      }
    }
  }
}

}  // namespace

void add_step(AbsorberAmounts& out, StepScattering* scattering, const Atmosphere& atmosphere,
              const LightPath& path, std::size_t step, const BandChoice& bands) {
  const AtmosphereSpec& spec = atmosphere.spec();
  const LightPath::Node &a = path.node[step], &b = path.node[step + 1];
  const double length_m = path.step_m[step];
  const AirProfile& profile = spec.profile;
  const AirSpectrum& molecular = out.grey(GreyAbsorber::kMolecularScattering);
  if (scattering && !atmosphere.turbid_levels_m().empty()) {
    scattering->cloud_depth.assign(kAirBandCount, 0.0);
    scattering->cloud_asymmetry.assign(kAirBandCount, 0.0);
  }
  // The amounts before are subtracted from those afterwards.
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t band = r.first; scattering && band < r.last; ++band) {
      scattering->molecular_depth[band] = molecular[band];
      scattering->grey_depth[band] = grey_depth(out, band);
      scattering->aerosol_depth[band] = scattering->asymmetry[band] = 0;
    }
  }
  add_gases(out, air_at(profile, a.height_m), air_at(profile, b.height_m), length_m,
            spec.cfc11_ppmv, spec.cfc12_ppmv, bands);
  add_aerosol(out, scattering, spec, atmosphere.surface_humidity_percent(), path, step, bands);
  add_cloud(out, scattering, atmosphere, path, step, bands);
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t band = r.first; scattering && band < r.last; ++band) {
      scattering->molecular_depth[band] = molecular[band] - scattering->molecular_depth[band];
      scattering->grey_depth[band] = grey_depth(out, band) - scattering->grey_depth[band];
    }
  }
}

AbsorberAmounts Atmosphere::amounts(const LightPath& path, const BandChoice& bands) const {
  AbsorberAmounts sum;
  for (std::size_t i = 0; i < path.step_m.size(); ++i) {
    add_step(sum, nullptr, *this, path, i, bands);
  }
  return sum;
}

std::optional<AbsorberAmounts> Atmosphere::sun_amounts(double height_m, double zenith_deg,
                                                       const BandChoice& bands) const {
  const LightPath path =
      look(spec_.profile, height_m, zenith_deg, std::numeric_limits<double>::infinity());
  if (path.end == PathEnd::kSurface) return std::nullopt;
  return amounts(path, bands);
}

AirSpectrum Atmosphere::sun_irradiance_w_m2_um(double height_m, const SunPlace& sun,
                                               const AbsorberAmounts* near) const {
  std::optional<AbsorberAmounts> amounts_to_sun = sun_amounts(height_m, sun.zenith_deg);
  if (!amounts_to_sun.has_value()) return AirSpectrum(kAirBandCount, 0.0);
  if (near) *amounts_to_sun += *near;
  AirSpectrum irradiance = transmittance(*amounts_to_sun);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    irradiance[b] *=
        solar_irradiance_w_m2_um(air_band_lambda_um(b)) / (sun.distance_au * sun.distance_au);
  }
  return irradiance;
}

PathRadiance Atmosphere::radiance(const LightPath& path, const PathLight& light,
                                  const AbsorberAmounts* near) const {
  return PathSums(*this, path, light, near).result();
}

PathRadiance Atmosphere::sky_radiance(double height_m, double zenith_deg, const PathLight& light,
                                      const AbsorberAmounts* near) const {
  return radiance(
      look(spec_.profile, height_m, zenith_deg, std::numeric_limits<double>::infinity()), light,
      near);
}

AirSpectrum Atmosphere::sky_irradiance_w_m2_um(double height_m, const PathLight& light,
                                               int zeniths) const {
  return downward_irradiance_w_m2_um(*this, height_m, light, zeniths);
}

}  // namespace irsig
