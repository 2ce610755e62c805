#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/plume/bent_plume.h"
#include "core/plume/exhaust_gas.h"
#include "core/plume/plume_grids.h"
#include "core/plume/voxel_volume.h"

namespace irsig {

// A volume as a generator makes it, ready to be written as VDB: x forward, y port, z up, metres.
// Grids: temperature [K], co2, h2o and co (mole fractions), soot (volume fraction); of the species
// those that there are.
struct GeneratedPlume {
  VoxelVolume volume;
  PlumeGrids grids;                // as they are to be read, at the origin of the body frame
  std::vector<PlumeStation> axis;  // of a funnel's plume
  Vec<Body> downwind{};
};

// The exhaust of a funnel whose opening is at the origin, seen from the ship.
struct FunnelPlume {
  PlumeExit exit;
  ExhaustSpec exhaust;
  double air_temperature_k = 288.15, air_pressure_pa = 101325;
  double wind_m_s = 0, wind_from_deg = 0;  // true wind; 0: from ahead, 90: from starboard
  double ship_speed_m_s = 0;               // ahead
  double length_m = 0;                     // of the axis
  double voxel_m = 0;
};

// Generates the bent plume (bent_plume.h) with a profile across: the fraction of exhaust gas is f0
// exp(-(r / b)^m), with flux and second moment of the uniform section. Near the opening f0 = 1 and
// m falls from a top hat to 2; then the profile is Gaussian (m = 2) and f0 falls. The plume is cut
// where it is a thousandth of f0, and at both ends. Voxels hold means of 2^3 points, amounts and
// their temperatures. Mole fractions are the exhaust's own, without the air's CO2 and H2O.
// INVALID_ARGUMENT: as bent_plume and exhaust_gas; voxels larger than the opening; more than
// kMostGeneratedBlocks.
[[nodiscard]] absl::StatusOr<GeneratedPlume> generate_funnel_plume(const FunnelPlume& plume);

// A homogeneous body: "slab" (length x width x height along x, y, z), "cylinder" (radius, length
// along x) or "sphere" (radius), centred. Faces of voxels at whole multiples of voxel_m; voxels
// that the surface cuts have the fractions times the share of 6^3 points that lies inside.
struct UniformPlume {
  std::string kind;
  double length_m = 0, width_m = 0, height_m = 0, radius_m = 0;
  double temperature_k = 0, pressure_pa = 101325;
  double co2 = 0, h2o = 0, co = 0, soot = 0;
  double voxel_m = 0;
};
[[nodiscard]] absl::StatusOr<GeneratedPlume> generate_uniform_plume(const UniformPlume& plume);

// 8^3 voxels each: 0.5 to 1 GB of file.
inline constexpr std::uint64_t kMostGeneratedBlocks = 100'000;

// Returns the relative wind that such a ship feels, as a vector towards which it blows: x forward,
// y starboard. [m/s]
[[nodiscard]] Vec<Body> relative_wind(double wind_m_s, double wind_from_deg, double ship_speed_m_s);

// A section's profile across (see above).
struct PlumeProfile {
  double f0 = 1, b_m = 1, m = 2;
  double cut_m = 1;  // radius where it ends
  [[nodiscard]] double at(double radius_m) const;
};
[[nodiscard]] PlumeProfile plume_profile(const PlumeStation& station, const PlumeExit& exit,
                                         double air_temperature_k);

}  // namespace irsig
