#pragma once

#include <span>
#include <vector>

namespace irsig {

// One layer of a horizontally homogeneous column in one band.
struct StreamLayer {
  double depth;                      // optical, >= 0
  double albedo;                     // single scattering, [0, 1]
  double asymmetry;                  // of a phase function without a forward peak, [0, 1)
  double planck_top, planck_bottom;  // radiance of a black body; linear in depth between them
};

// Light on the column's boundaries. Radiances and fluxes in the units of the layers' `planck`.
struct StreamBoundaries {
  double down_radiance = 0;   // isotropic, on the top
  double up_radiance = 0;     // of what is below the column, without what it reflects
  double surface_albedo = 0;  // diffuse, of what is below the column, [0, 1]
  double sun_irradiance = 0;  // normal to the beam, at the top
  double sun_cosine = 1;      // of the sun's zenith angle, (0, 1]
};

// Diffuse radiance at a boundary: mean + slope x cosine, of the zenith angle of the direction in
// which light travels.
struct StreamLight {
  double mean, slope;
  // Mean over all directions of radiance x Legendre's second polynomial of that cosine; 0 for two
  // streams.
  double second = 0;
};

// Returns the diffuse light at the layers' boundaries, from the top down; the sun's beam is not
// part of it.
//
// Two streams: hemispheric means of thermal light [toon1989], Eddington's of sunlight
// [joseph1976]; layers are joined by adding, which stays stable for any depth. Thermal light of an
// isothermal column above a black body of its temperature is exact. Against discrete ordinates,
// fluxes err by 1 to 3 % where scattering matters [toon1989].
[[nodiscard]] std::vector<StreamLight> diffuse_light(std::span<const StreamLayer> layers,
                                                     const StreamBoundaries& boundaries);

}  // namespace irsig
