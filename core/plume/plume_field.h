#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "core/plume/block_tree.h"
#include "core/plume/plume_grids.h"
#include "core/plume/voxel_volume.h"

namespace irsig {

// The gas at a place, as the field's interpolation takes it together: sums over centres of voxels
// times their shares. `carbon` is what temperatures are weighted with: moles of CO2, H2O, CO, and
// of soot as carbon of 1800 kg/m3, so that a plume of soot alone has a temperature too.
struct GasSums {
  double weight = 0;                           // [mol/m3]
  double weight_temperature = 0;               // [mol K/m3]
  double weight_pressure = 0;                  // [mol Pa/m3]
  std::array<double, kPlumeSpecies> amount{};  // CO2, H2O, CO [mol/m3]; soot volume fraction
};
inline constexpr double kSootMolPerM3 = 1800 / 0.012011;  // carbon atoms in solid soot

// A stored voxel: its weight, temperature [K] and pressure [Pa], its amounts as GasSums
// has them, and a 0. Temperatures stay exact, so that gas of one temperature has that everywhere.
using StoredGas = std::array<float, 8>;

// Statistics and warnings of a field that was read.
struct PlumeReport {
  std::uint64_t gas_voxels = 0;
  std::uint64_t warm_without_gas = 0;  // active temperature, but no CO2, H2O, CO or soot
  double least_k = 0, most_k = 0;
  double least_pa = 0, most_pa = 0;
  double most_soot = 0;                        // volume fraction
  std::array<double, kPlumeSpecies> amount{};  // of all voxels: CO2, H2O, CO [mol]; soot [m3]
};

// Emission of voxels as thin gas, for aiming: amount x blackbody at 4.3 and 10 um [mol W/(m2 sr
// um)]. A point is one voxel where the voxel is a large part of the sum; else 2^3 voxels.
struct PlumePoint {
  Vec<Body> at;       // their middle
  float reach_m = 0;  // from there: the voxel next to them, along the longest axis of the lattice
  std::array<float, 2> thin_w{};
  float amount_mol = 0;  // GasSums::weight of all of it
};

// Hot gas on a sparse lattice, placed in the body frame. Immutable: any number of threads may read.
//
// Memory: 32 bytes for each voxel that holds gas (for all 512 of a block where at least half do),
// and 200 bytes a block.
class PlumeField {
 public:
  // Makes the field. INVALID_ARGUMENT names the grid, the value and the first voxel: not finite,
  // temperatures of 0 to 1, gas colder than kLeastPlumeK, a fraction outside 0 to 1 or a sum of
  // mole fractions above 1, gas without temperature or pressure, a species whose background is not
  // 0, no gas at all; a singular or badly conditioned lattice, or one larger than 1e6 m.
  static absl::StatusOr<std::shared_ptr<const PlumeField>> make(VoxelVolume volume,
                                                                const PlumeReading& reading);

  [[nodiscard]] const PlumeReport& report() const { return report_; }
  [[nodiscard]] PlumeInterpolation interpolation() const { return interpolation_; }
  // Return index coordinates of a place or direction: voxel (i, j, k) is centred at (i, j, k).
  [[nodiscard]] std::array<double, 3> index_from_body(Vec<Body> at) const;
  [[nodiscard]] std::array<double, 3> index_direction(Vec<Body> direction) const;
  [[nodiscard]] Vec<Body> body_from_index(const std::array<double, 3>& at) const;
  [[nodiscard]] double voxel_volume_m3() const { return voxel_volume_m3_; }
  [[nodiscard]] const std::vector<PlumePoint>& points() const { return points_; }
  // Corners of the box, in index coordinates, outside of which there is no gas; the field reaches
  // half a voxel (kConstant) or one (kLinear) beyond centres.
  struct Box {
    std::array<double, 3> low, high;
  };
  [[nodiscard]] Box bounds() const { return bounds_; }
  [[nodiscard]] std::size_t bytes() const;
  // Returns the gas on a lattice of twice the edge, each voxel the mean of eight: the same amounts,
  // temperatures and pressures weighted with the amounts. The change of the light estimates the
  // error of the lattice's resolution. Made when first asked for, by one thread; an eighth of the
  // memory. Errors: an edge of more than 1e4 m.
  [[nodiscard]] const absl::StatusOr<std::shared_ptr<const PlumeField>>& at_half_resolution() const;

  // Cells for the marcher. A ray crosses a cell in one step: between 8 centres (kLinear; cell i is
  // [i, i + 1]) or around one (kConstant; cell i is [i - 1/2, i + 1/2]).
  struct CellBlock {
    VoxelMask filled{};  // cells that hold gas
    // kLinear: the blocks of values at +0 or +8 along x (bit 2), y (1), z (0); kConstant: the
    // first.
    std::array<std::int32_t, 8> values{};  // -1: none
    bool uniform = false;                  // the whole block is one gas
  };
  [[nodiscard]] const BlockTree& cells() const { return cells_; }
  // Returns the box of each block of 8^3 cells that hold gas, in index coordinates.
  [[nodiscard]] std::vector<Box> cell_boxes() const;
  [[nodiscard]] const CellBlock& cell_block(std::int64_t i) const {
    return cell_blocks_[static_cast<std::size_t>(i)];
  }
  // Returns the gas of the voxel (x, y, z), each 0 to 8, counted from a cell block's first.
  [[nodiscard]] GasSums at_voxel(const CellBlock& block, unsigned x, unsigned y, unsigned z) const;
  // Returns that voxel as it is stored; marching asks for each corner of a cell.
  [[nodiscard]] const StoredGas& stored(const CellBlock& block, unsigned x, unsigned y,
                                        unsigned z) const;

 private:
  struct ValueBlock {
    VoxelMask gas{};
    std::array<std::uint16_t, 8> before{};
    VoxelBlock::Form form{};
    std::uint64_t first = 0;  // voxel of values_
  };
  friend class PlumeFieldMaker;
  PlumeField() = default;
  [[nodiscard]] absl::StatusOr<std::shared_ptr<const PlumeField>> make_half() const;

  PlumeReport report_;
  PlumeInterpolation interpolation_{};
  std::array<double, 12> body_from_index_{}, index_from_body_{};
  double voxel_volume_m3_ = 0;
  Box bounds_{};
  BlockTree cells_;
  std::vector<BlockTree::Cell> cell_origin_;  // [cell block]
  std::vector<CellBlock> cell_blocks_;
  std::vector<PlumePoint> points_;
  std::vector<ValueBlock> value_blocks_;
  std::vector<StoredGas> values_;  // [voxel]
  mutable std::once_flag half_once_;
  mutable absl::StatusOr<std::shared_ptr<const PlumeField>> half_;
};

// Reads a VDB file (in a process of its own, vdb_subprocess.h) and makes the field. Errors begin
// with file_name.
[[nodiscard]] absl::StatusOr<std::shared_ptr<const PlumeField>> import_plume(
    std::string_view file, const std::string& file_name, const PlumeGrids& grids);

// Makes the field of a generated volume, as a file of the volume would be read.
[[nodiscard]] absl::StatusOr<std::shared_ptr<const PlumeField>> plume_of(VoxelVolume volume,
                                                                         const PlumeGrids& grids);

}  // namespace irsig
