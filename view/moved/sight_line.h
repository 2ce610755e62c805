#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/environment/environment.h"
#include "core/spectral/band.h"
#include "view/moved/silhouette.h"

namespace irsig {

// Factors on a signature's parts by cause on their way to the sensor, for one line of sight, one
// condition and one band, on the band's stored wavelengths.
struct SightLine {
  // Causes in the order of the stored spectra: emitted, sun, sky, sea and parts reflected.
  static constexpr std::size_t kCauses = 5;
  static constexpr std::array<std::size_t, 2> kReflected = {2, 3};  // from around: sky, sea
  using Values = std::vector<double>;                               // [stored wavelength]

  // Integrals over each bin. With the weights of a bin's mean they are means. With those of the
  // in-band integral they are the contribution of the bin, so that sums over bins are in-band.
  struct Integrals {
    std::array<Values, kCauses> arriving;  // share of each cause's radiance that arrives
    Values width, transmittance, path_radiance;
    // Mean radiance from behind the silhouette, as it arrives, and bounds on it: of the fractions
    // of the silhouette before each direction, and between the directions.
    Values behind, background_fraction_bound, background_between_bound;
    Values model_error_transmittance, model_error_path_radiance;  // empty: none
    // One sigma of which of both skies of a broken cloud the line crosses (environment.one_sky),
    // with its sign: all three change together. Empty: there is one sky.
    Values choice_transmittance, choice_path_radiance, choice_behind;
  };
  Integrals bin, band;

  // Arriving fraction of the mean radiance of each direction of sky and sea, [side][direction x
  // bin]; negative: no radiance comes from the direction.
  std::array<Values, 2> directions;
};

// Computes the air between target and sensor.
//   environment  on the band's nodes
//   nodes        the directions of environment.around
//   before       fractions of the silhouette before each node of environment.background_apparent
// Reflected sky and sea arrive as the mean over the solid angle of their side, because the mirror
// directions of the target are no longer known.
[[nodiscard]] SightLine sight_line(const ViewEnvironment& environment, const DirectionNodes& nodes,
                                   const BandGrid& grid, const Silhouette::Fractions& before);

}  // namespace irsig
