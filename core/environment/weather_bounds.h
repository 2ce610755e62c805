#pragma once

#include <vector>

#include "core/atmosphere/absorber_amounts.h"
#include "core/environment/fit/direction_nodes.h"
#include "core/environment/view_environment.h"
#include "core/environment/weather_spec.h"

namespace irsig {

// The most that light can be, from the amounts of air straight up and down alone: no ring of the
// sky is computed. docs/explanation/methods/atmosphere.md, "Bounds of light". Private to
// core/environment, as all of this header.
inline constexpr double kBoundsTopM = 10e3;

void scale_amounts(AbsorberAmounts& amounts, double factor);

struct WeatherBounds {
  WeatherBounds(const WeatherSpec& spec, const Atmosphere& atmosphere, double height_m,
                const DirectionNodes& rings, const BandChoice& bands);

  // Returns the largest phase function of the aerosol at that angle or any larger, whatever its
  // asymmetry.
  [[nodiscard]] AirSpectrum aerosol_per_sr(double cosine) const;
  [[nodiscard]] bool grey() const;    // the surface
  [[nodiscard]] bool glints() const;  // the surface has glitter

  SurfaceBoundary surface;
  double height_m;
  BandChoice bands;
  std::vector<double> sky_sine;  // of the rings
  AirSpectrum thermal;           // radiance of sky and surface
  // Amounts from some heights above the target straight up to kBoundsTopM, with a margin.
  struct Above {
    double height_m;
    AbsorberAmounts amounts;
  };
  std::vector<Above> above;
  AirSpectrum absorption;  // transmittance straight up of all that absorbs and does not scatter
  // Scattering depths straight up to space and straight down to the surface.
  AirSpectrum scattering_up, scattering_down;
  AirSpectrum molecular;  // the most that molecules scatter of light on any path to the target
  bool no_aerosol = false;
  bool cloudy = false;  // light is scattered more than once, and into narrow forward peaks
  AirSpectrum smallest_asymmetry, largest_asymmetry;
  AirSpectrum aerosol_sum;  // of aerosol_per_sr() over all directions
  // Factor by which the nodes of the sky can exceed the fitted means.
  double overshoot = 0;
  AirSpectrum mirrored_sky;  // by the surface, of a unit of the sky's light, over all directions

 private:
  void mirror_sky();
};

}  // namespace irsig
