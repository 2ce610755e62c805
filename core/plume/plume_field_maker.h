#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/plume/plume_field.h"

namespace irsig {

// Makes a field from a volume: checks every voxel, keeps the voxels that hold gas, and builds the
// tree of cells. Used once.
class PlumeFieldMaker {
 public:
  PlumeFieldMaker(VoxelVolume volume, const PlumeReading& reading)
      : volume_(std::move(volume)), reading_(reading) {}
  [[nodiscard]] absl::StatusOr<std::shared_ptr<const PlumeField>> make();

 private:
  // A kind of faulty voxels: their number, the first of them and its value.
  struct Fault {
    std::uint64_t count = 0;
    std::array<std::int32_t, 3> first{};
    double value = 0;
    void add(const std::array<std::int32_t, 3>& at, double of) {
      if (count++ == 0) {
        first = at;
        value = of;
      }
    }
  };
  // One voxel as the file has it, in units of this program.
  struct Voxel {
    std::array<std::int32_t, 3> at{};
    bool finite = true, has_temperature = false, has_pressure = false;
    double temperature_k = 0, pressure_pa = 0;
    std::array<double, kPlumeSpecies> fraction{};
  };

  [[nodiscard]] absl::Status match_channels();
  [[nodiscard]] absl::Status check_lattice();
  [[nodiscard]] Voxel voxel_of(const VoxelMask* masks, unsigned offset, const float* values,
                               const std::array<std::int32_t, 3>& origin);
  [[nodiscard]] bool has_gas(const Voxel& voxel);
  void check_gas(const Voxel& voxel);
  void take_block(std::size_t b, std::size_t& read);
  [[nodiscard]] StoredGas store(const Voxel& voxel, std::uint64_t voxels);
  [[nodiscard]] absl::Status faults() const;
  void sort_values();
  void build_cells();
  void build_points();
  void build_filled(PlumeField::CellBlock& block) const;
  [[nodiscard]] bool is_uniform(const PlumeField::CellBlock& block) const;

  VoxelVolume volume_;
  const PlumeReading reading_;
  std::unique_ptr<PlumeField> field_;
  std::vector<std::size_t> channel_;                      // of the volume, for each of the reading
  std::vector<BlockTree::Cell> origin_;                   // of value blocks
  std::vector<Fault> not_finite_, outside_, background_;  // by channel of the reading
  Fault cold_, hot_, without_temperature_, without_pressure_, pressure_, sum_, far_;
  double most_raw_temperature_ = 0;
};

}  // namespace irsig
