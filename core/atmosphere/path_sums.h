#pragma once

#include <cstddef>
#include <vector>

#include "core/atmosphere/atmosphere.h"

namespace irsig {

// What one step scatters, apart from how the amounts sum it.
struct StepScattering {
  AirSpectrum aerosol_depth = AirSpectrum(kAirBandCount, 0.0);
  AirSpectrum molecular_depth = AirSpectrum(kAirBandCount, 0.0);
  AirSpectrum asymmetry = AirSpectrum(kAirBandCount, 0.0);
};

void add_step(AbsorberAmounts& out, StepScattering* scattering, const AtmosphereSpec& spec,
              double surface_humidity_percent, const LightPath& path, std::size_t step);

// The sums along one path that Atmosphere::radiance returns.
class PathSums {
 public:
  PathSums(const Atmosphere& atmosphere, double surface_humidity_percent, const LightPath& path,
           const PathLight& light, const AbsorberAmounts* near);

  [[nodiscard]] PathRadiance result();

 private:
  void add_thermal(std::size_t step, const AirSpectrum& t_near, const AirSpectrum& t_far,
                   const AirSpectrum& planck_near, const AirSpectrum& planck_far);
  void add_scattered(std::size_t step, const AirSpectrum& source_near,
                     const AirSpectrum& source_far);
  [[nodiscard]] AirSpectrum planck_at(std::size_t node) const;
  // Irradiance that arrives at the observer after a turn at the node, per band; 0 in shadow.
  [[nodiscard]] AirSpectrum sunlight_by(std::size_t node, const AbsorberAmounts& to_node) const;
  void prepare_sun();
  [[nodiscard]] double sun_zenith_deg(std::size_t node) const;
  [[nodiscard]] double cos_scattering(std::size_t step) const;
  void add_model_error();

  const Atmosphere& atmosphere_;
  double surface_humidity_percent_;
  const LightPath& path_;
  const PathLight& light_;
  const AbsorberAmounts* near_;
  PathRadiance out_;
  std::vector<StepScattering> scattering_;
  AbsorberAmounts sum_;
  struct SunNode {
    std::size_t node;
    bool lit;
    AbsorberAmounts amounts;
  };
  std::vector<SunNode> sun_node_;
};

[[nodiscard]] AirSpectrum downward_irradiance_w_m2_um(const Atmosphere& atmosphere, double height_m,
                                                      const PathLight& light, int zeniths);

}  // namespace irsig
