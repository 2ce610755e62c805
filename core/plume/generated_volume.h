#pragma once

#include <array>
#include <vector>

#include "core/plume/generate_plume.h"

namespace irsig {

// A volume that generators fill block by block: temperature and fractions of one composition.
class GeneratedVolume {
 public:
  // fraction: CO2, H2O, CO, soot of undiluted gas. Faces of voxels lie at multiples of voxel_m.
  GeneratedVolume(double voxel_m, double pressure_pa,
                  const std::array<double, kPlumeSpecies>& fraction);
  // Sets a voxel of the block to be added; `share` multiplies the mole fractions, `soot_fraction`
  // the soot's volume fraction.
  void set(unsigned offset, double temperature_k, double share, double soot_fraction);
  void add_block(std::array<std::int32_t, 3> origin);
  void finish(GeneratedPlume& out);

 private:
  VoxelVolume volume_;
  PlumeGrids grids_;
  std::vector<std::pair<double, bool>> fraction_;  // of channels 1 ...; whether it is soot
  std::vector<float> value_;
  VoxelMask mask_{};
};

}  // namespace irsig
