#pragma once

#include <cstdint>
#include <span>

#include "core/thermal/scene/thermal_faces.h"

namespace irsig {

// The sun as a disk on the sky.
struct SunDisk {
  Vec<Body> direction;  // unit vector towards its centre
  double angular_radius_rad;
};
struct SunSettings {
  std::uint32_t points = 4;  // a power of two, at most 16
  std::uint64_t seed = 1;
  double surface_z_m = 0;
};
// Computes the irradiance of each face by a sun with one unit of irradiance normal to its beam: the
// cosine of incidence times the fraction of the face that sees the sun. Traces `points` rays from
// each face to points on the sun's disk. Sets 0 for a sun below the horizon's plane and for faces
// below surface_z_m (as exchange_factors has it).
//   out  [face]
void sun_visibility(const Target& target, const ThermalFaces& faces, const SunDisk& sun,
                    const SunSettings& settings, std::span<float> out);

}  // namespace irsig
