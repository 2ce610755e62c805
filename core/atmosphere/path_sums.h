#pragma once

#include <cstddef>
#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/step_scattering.h"

namespace irsig {

void add_step(AbsorberAmounts& out, StepScattering* scattering, const Atmosphere& atmosphere,
              const LightPath& path, std::size_t step, const BandChoice& bands = BandChoice());

// Computes Planck's function at the bands' centres.
void planck_spectrum(AirSpectrum& out, double temperature_k, const BandChoice& bands);

// Adds a step's thermal radiance to the radiance behind the step. t: transmittance from the
// observer to the step's ends; planck: Planck's function at the air's temperature there.
//   B linear in optical depth x from node to node, t = exp(-depth):
//   integral of B exp(-x) dx = B_near (1 - t) + (B_far - B_near) ((1 - t) / depth - t).
// Only the absorbed fraction of the extinction emits.
void add_emission(AirSpectrum& out, const StepScattering& scattering, const AirSpectrum& t_near,
                  const AirSpectrum& t_far, const AirSpectrum& planck_near,
                  const AirSpectrum& planck_far, const BandChoice& bands);
// Replaces Planck's function at a step's ends by the source of everything but the light that air
// and aerosol scatter: the cloud in the step scatters the mean radiance around.
//   t_near, t_far        transmittances at the step's ends
//   mean_near, mean_far  CloudLight's mean radiances there
void add_cloud_source(AirSpectrum& planck_near, AirSpectrum& planck_far,
                      const StepScattering& scattering, const AirSpectrum& t_near,
                      const AirSpectrum& t_far, const AirSpectrum& mean_near,
                      const AirSpectrum& mean_far, const BandChoice& bands);
// Adds the part of the surroundings' mean radiance that the step scatters to the observer.
void add_surroundings(AirSpectrum& out, const StepScattering& scattering, const AirSpectrum& t_near,
                      const AirSpectrum& t_far, const BandChoice& bands);
// Computes mean_of_decay of all bands.
void mean_of_decay(AirSpectrum& out, const AirSpectrum& a, const AirSpectrum& b,
                   const AirSpectrum& grey_depth, const BandChoice& bands);
// Adds a depth to a sum of depths, and its asymmetry to their mean.
void add_scattering(double& sum, double& mean_asymmetry, double depth, double asymmetry);
// Adds a step to the sum of the steps in front of it.
void merge(StepScattering& sum, const StepScattering& step, const BandChoice& bands);

// Return phase functions, whose integral over all directions is 1.
[[nodiscard]] double henyey_greenstein_per_sr(double asymmetry, double cosine);
[[nodiscard]] double rayleigh_per_sr(double cosine);

// The sums along one path that Atmosphere::radiance returns.
class PathSums {
 public:
  PathSums(const Atmosphere& atmosphere, const LightPath& path, const PathLight& light,
           const AbsorberAmounts* near);

  [[nodiscard]] PathRadiance result();

 private:
  void add_scattered(std::size_t step, const AirSpectrum& source_near,
                     const AirSpectrum& source_far);
  void planck_at(AirSpectrum& out, std::size_t node) const;
  // Returns the irradiance that arrives at the observer after a turn at the node, per band; 0 in
  // shadow.
  [[nodiscard]] AirSpectrum sunlight_by(std::size_t node, const AbsorberAmounts& to_node) const;
  void prepare_sun();
  // Adds the two neighbouring nodes between which the Earth's shadow ends.
  void add_edge_of_shadow(std::size_t first, std::size_t last, bool last_is_lit);
  [[nodiscard]] double sun_zenith_deg(std::size_t node) const;
  [[nodiscard]] double cos_scattering(std::size_t step) const;
  void add_model_error();

  const Atmosphere& atmosphere_;
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
