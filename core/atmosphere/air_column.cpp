#include "core/atmosphere/air_column.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/constants.h"

namespace irsig {
namespace {

// Extinction goes with wavelength to the power of minus this [angstrom1961]: haze of the land; of
// the sea, whose particles are larger; of fog, whose droplets are larger than both.
double angstrom_exponent(AerosolKind kind) {
  switch (kind) {
    case AerosolKind::kNone:
    case AerosolKind::kRural:
    case AerosolKind::kUrban:
    case AerosolKind::kTropospheric:
      return 1.3;
    case AerosolKind::kMaritime:
    case AerosolKind::kNavyMaritime:
      return 0.6;
    case AerosolKind::kAdvectionFog:
    case AerosolKind::kRadiationFog:
      return 0;
  }
  return 0;
}

}  // namespace

double aerosol_depth(const AerosolSpec& spec, double surface_humidity_percent,
                     double wavelength_nm) {
  return aerosol_depth_550(spec, surface_humidity_percent) *
         std::pow(550.0 / wavelength_nm, angstrom_exponent(spec.kind));
}

double ozone_cm(const AirProfile& profile) {
  constexpr double kLoschmidtM3 = 2.686780111e25;
  const auto per_m3 = [](const AirLevel& l) {
    return 1e-6 * l.gas.o3_ppmv * l.pressure_pa / (kBoltzmannJK * l.temperature_k);
  };
  double column_m2 = 0;
  for (std::size_t i = 1; i < profile.level.size(); ++i) {
    const AirLevel &low = profile.level[i - 1], &high = profile.level[i];
    column_m2 += 0.5 * (per_m3(low) + per_m3(high)) * (high.height_m - low.height_m);
  }
  return 100 * column_m2 / kLoschmidtM3;
}

double standard_pressure_pa(double height_m) {
  return 101325 * std::pow(std::max(0.0, 1 - 2.25577e-5 * height_m), 5.25588);
}

}  // namespace irsig
