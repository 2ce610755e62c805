#include "core/plume/plume_field.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/plume/plume_field_maker.h"
#include "core/plume/vdb_subprocess.h"
#include "fmt/format.h"

namespace irsig {
namespace {

std::array<double, 3> times(const std::array<double, 12>& m, double x, double y, double z,
                            double w) {
  std::array<double, 3> out{};
  for (std::size_t r = 0; r < 3; ++r)
    out[r] = m[4 * r] * x + m[4 * r + 1] * y + m[4 * r + 2] * z + m[4 * r + 3] * w;
  return out;
}

}  // namespace

std::array<double, 3> PlumeField::index_from_body(Vec<Body> at) const {
  // The place first, relative to the lattice's origin: so that far away nothing cancels twice.
  return times(index_from_body_, at.x - body_from_index_[3], at.y - body_from_index_[7],
               at.z - body_from_index_[11], 0);
}

std::array<double, 3> PlumeField::index_direction(Vec<Body> direction) const {
  return times(index_from_body_, direction.x, direction.y, direction.z, 0);
}

Vec<Body> PlumeField::body_from_index(const std::array<double, 3>& at) const {
  const auto out = times(body_from_index_, at[0], at[1], at[2], 1);
  return {out[0], out[1], out[2]};
}

std::vector<PlumeField::Box> PlumeField::cell_boxes() const {
  const double low = interpolation_ == PlumeInterpolation::kLinear ? 0 : -0.5;
  std::vector<Box> out;
  for (const BlockTree::Cell& origin : cell_origin_) {
    Box& box = out.emplace_back();
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] = origin[a] + low;
      box.high[a] = box.low[a] + 8;
    }
  }
  return out;
}

std::size_t PlumeField::bytes() const {
  return cells_.bytes() + cell_blocks_.capacity() * sizeof(CellBlock) +
         value_blocks_.capacity() * sizeof(ValueBlock) + values_.capacity() * sizeof(StoredGas);
}

const StoredGas& PlumeField::stored(const CellBlock& block, unsigned x, unsigned y,
                                    unsigned z) const {
  static constexpr StoredGas kNoGas{};
  const std::int32_t i = block.values[(x >> 3) << 2 | (y >> 3) << 1 | z >> 3];
  if (i < 0) return kNoGas;
  const ValueBlock& values = value_blocks_[static_cast<std::size_t>(i)];
  const unsigned offset = (x & 7) << 6 | (y & 7) << 3 | (z & 7);
  const std::uint64_t word = values.gas[offset >> 6], bit = std::uint64_t{1} << (offset & 63);
  if ((word & bit) == 0) return kNoGas;
  std::uint64_t voxel = values.first;
  if (values.form == VoxelBlock::Form::kDense) voxel += offset;
  if (values.form == VoxelBlock::Form::kPacked)
    voxel += values.before[offset >> 6] + static_cast<unsigned>(std::popcount(word & (bit - 1)));
  return values_[voxel];
}

GasSums PlumeField::at_voxel(const CellBlock& block, unsigned x, unsigned y, unsigned z) const {
  const StoredGas& gas = stored(block, x, y, z);
  const auto at = [&](std::size_t i) { return static_cast<double>(gas[i]); };
  return {at(0), at(0) * at(1), at(0) * at(2), {at(3), at(4), at(5), at(6)}};
}

absl::StatusOr<std::shared_ptr<const PlumeField>> PlumeField::make(VoxelVolume volume,
                                                                   const PlumeReading& reading) {
  return PlumeFieldMaker(std::move(volume), reading).make();
}

absl::StatusOr<std::shared_ptr<const PlumeField>> plume_of(VoxelVolume volume,
                                                           const PlumeGrids& grids) {
  ASSIGN_OR_RETURN(const PlumeReading reading, check_plume_grids(grids));
  return PlumeField::make(std::move(volume), reading);
}

absl::StatusOr<std::shared_ptr<const PlumeField>> import_plume(std::string_view file,
                                                               const std::string& file_name,
                                                               const PlumeGrids& grids) {
  const auto named = [&](const absl::Status& status) {
    return absl::Status(status.code(),
                        fmt::format("{}: {}", file_name, std::string(status.message())));
  };
  const absl::StatusOr<PlumeReading> reading = check_plume_grids(grids);
  if (!reading.ok()) return named(reading.status());
  absl::StatusOr<VoxelVolume> volume = read_vdb_apart(file, reading->grid);
  if (!volume.ok()) return named(volume.status());
  auto field = PlumeField::make(*std::move(volume), *reading);
  return field.ok() ? std::move(field) : named(field.status());
}

}  // namespace irsig
