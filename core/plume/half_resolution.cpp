#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/constants.h"
#include "core/plume/plume_field.h"

namespace irsig {
namespace {

using Cell = BlockTree::Cell;
using Values = std::array<float, 2 + kPlumeSpecies>;  // K, Pa, fractions

Cell halved(const Cell& at) { return {at[0] >> 1, at[1] >> 1, at[2] >> 1}; }  // also of negatives
Cell origin_of_block(const Cell& at) { return {at[0] & ~7, at[1] & ~7, at[2] & ~7}; }

void add(const GasSums& voxel, double times, GasSums& sum) {
  sum.weight += times * voxel.weight;
  sum.weight_temperature += times * voxel.weight_temperature;
  sum.weight_pressure += times * voxel.weight_pressure;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) sum.amount[s] += times * voxel.amount[s];
}

// Returns the values of sums over eight voxels, the empty ones among them.
Values values_of(const GasSums& eight) {
  const double temperature_k = eight.weight_temperature / eight.weight;
  double pressure_pa = eight.weight_pressure / eight.weight;
  std::array<double, kPlumeSpecies> fraction{};
  for (std::size_t s = 0; s < kPlumeSpecies; ++s)
    fraction[s] =
        eight.amount[s] / 8 * (s == kSoot ? 1 : kGasConstantJMolK * temperature_k / pressure_pa);
  // Beside much soot the means of temperatures and amounts may not go together.
  if (const double sum = fraction[0] + fraction[1] + fraction[2]; sum > 1) {
    pressure_pa = std::min(pressure_pa * sum, kMostPlumePa);
    for (std::size_t s = 0; s < kSoot; ++s) fraction[s] /= sum;
  }
  return {static_cast<float>(temperature_k), static_cast<float>(pressure_pa),
          static_cast<float>(fraction[0]),   static_cast<float>(fraction[1]),
          static_cast<float>(fraction[2]),   static_cast<float>(fraction[3])};
}

}  // namespace

absl::StatusOr<std::shared_ptr<const PlumeField>> PlumeField::make_half() const {
  VoxelVolume volume;
  volume.channel = {"temperature", "pressure", "co2", "h2o", "co", "soot"};
  volume.background.assign(volume.channel.size(), 0.0F);
  // Voxel i of the new lattice is 2 i and 2 i + 1 of the old one.
  for (std::size_t r = 0; r < 3; ++r) {
    const double* old = body_from_index_.data() + 4 * r;
    double* to = volume.world_from_index.data() + 4 * r;
    for (std::size_t c = 0; c < 3; ++c) to[c] = 2 * old[c];
    to[3] = old[3] + 0.5 * (old[0] + old[1] + old[2]);
  }
  PlumeReading reading;
  reading.grid = volume.channel;
  reading.interpolation = interpolation_;
  reading.temperature = {.name = "temperature", .channel = 0};
  reading.pressure = {.name = "pressure", .channel = 1};
  constexpr std::array<const char*, kPlumeSpecies> kNames = {"co2", "h2o", "co", "soot"};
  for (std::size_t s = 0; s < kPlumeSpecies; ++s)
    reading.species[s] = {.name = kNames[s], .channel = static_cast<int>(2 + s)};
  for (const std::size_t diagonal : {0U, 5U, 10U}) reading.body_from_world[diagonal] = 1;

  // Blocks whose own voxels hold gas, by the block that they become a part of.
  std::vector<std::pair<Cell, std::size_t>> old;
  for (std::size_t c = 0; c < cell_blocks_.size(); ++c)
    if (cell_blocks_[c].values[0] >= 0)
      old.emplace_back(origin_of_block(halved(cell_origin_[c])), c);
  std::sort(old.begin(), old.end());
  VolumeWriter writer(volume);
  std::vector<GasSums> sum(512);
  std::vector<float> values(512 * volume.channel.size());
  for (std::size_t begin = 0; begin < old.size();) {
    const Cell origin = old[begin].first;
    std::fill(sum.begin(), sum.end(), GasSums{});
    std::size_t end = begin;
    for (; end < old.size() && old[end].first == origin; ++end) {
      const CellBlock& block = cell_blocks_[old[end].second];
      const Cell first = halved(cell_origin_[old[end].second]);
      const auto place = [&](unsigned x, unsigned y, unsigned z) {
        return static_cast<std::size_t>((first[0] - origin[0] + static_cast<int>(x)) * 64 +
                                        (first[1] - origin[1] + static_cast<int>(y)) * 8 +
                                        (first[2] - origin[2] + static_cast<int>(z)));
      };
      if (value_blocks_[static_cast<std::size_t>(block.values[0])].form ==
          VoxelBlock::Form::kUniform) {
        const GasSums one = at_voxel(block, 0, 0, 0);
        for (unsigned n = 0; n < 64; ++n) add(one, 8, sum[place(n >> 4, n >> 2 & 3, n & 3)]);
        continue;
      }
      for (unsigned v = 0; v < 512; ++v) {
        const GasSums voxel = at_voxel(block, v >> 6, v >> 3 & 7, v & 7);
        if (voxel.weight > 0) add(voxel, 1, sum[place(v >> 7, v >> 4 & 3, v >> 1 & 3)]);
      }
    }
    VoxelMask mask{};
    bool uniform = true;
    for (unsigned v = 0; v < 512; ++v) {
      if (!(sum[v].weight > 0)) continue;
      mask[v >> 6] |= std::uint64_t{1} << (v & 63);
      const Values one = values_of(sum[v]);
      std::copy(one.begin(), one.end(), values.begin() + static_cast<std::ptrdiff_t>(v * 6));
    }
    for (unsigned v = 1; v < 512; ++v)
      uniform &= std::equal(values.begin(), values.begin() + 6, values.begin() + 6 * v);
    if (uniform && count_of(mask) == 512)
      writer.add_uniform(origin, {values.begin(), values.begin() + 6});
    else
      writer.add(origin, std::vector<VoxelMask>(volume.channel.size(), mask), values);
    begin = end;
  }
  return make(std::move(volume), reading);
}

const absl::StatusOr<std::shared_ptr<const PlumeField>>& PlumeField::at_half_resolution() const {
  std::call_once(half_once_, [this] { half_ = make_half(); });
  return half_;
}

}  // namespace irsig
