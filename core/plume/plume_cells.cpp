// The cells that rays cross, from the voxels that hold gas.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/plume/plume_field_maker.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

using Cell = BlockTree::Cell;

constexpr std::uint64_t kColumn0 = 0x0101010101010101;  // z = 0 of a plane: bits 8 y + z
constexpr std::uint64_t kRow0 = 0xff;                   // y = 0

// Whether a block has gas on the faces that the cells of the block before it touch.
bool reaches_back(const VoxelMask& gas, bool x, bool y, bool z) {
  std::uint64_t plane = 0;
  for (std::size_t i = 0; i < (x ? 1U : 8U); ++i) plane |= gas[i];
  if (y) plane &= kRow0;
  if (z) plane &= kColumn0;
  return plane != 0;
}

}  // namespace

// Bit (x, y, z): one of the voxels x to x + 1, y to y + 1, z to z + 1 holds gas.
void PlumeFieldMaker::build_filled(PlumeField::CellBlock& block) const {
  const auto plane = [&](unsigned x, unsigned dy, unsigned dz) -> std::uint64_t {
    const std::int32_t i = block.values[(x >> 3) << 2 | dy << 1 | dz];
    return i < 0 ? 0 : field_->value_blocks_[static_cast<std::size_t>(i)].gas[x & 7];
  };
  const auto with_next_z = [&](unsigned x, unsigned dy) {
    const std::uint64_t own = plane(x, dy, 0), next = plane(x, dy, 1);
    return own | (own >> 1 & ~(kColumn0 << 7)) | (next & kColumn0) << 7;
  };
  std::array<std::uint64_t, 9> flat{};
  for (unsigned x = 0; x < 9; ++x) {
    const std::uint64_t own = with_next_z(x, 0);
    flat[x] = own | own >> 8 | (with_next_z(x, 1) & kRow0) << 56;
  }
  for (unsigned x = 0; x < 8; ++x) block.filled[x] = flat[x] | flat[x + 1];
}

bool PlumeFieldMaker::is_uniform(const PlumeField::CellBlock& block) const {
  const bool linear = reading_.interpolation == PlumeInterpolation::kLinear;
  const StoredGas* first = nullptr;
  for (std::size_t n = 0; n < (linear ? 8U : 1U); ++n) {
    if (block.values[n] < 0) return false;
    const auto& values = field_->value_blocks_[static_cast<std::size_t>(block.values[n])];
    if (values.form != VoxelBlock::Form::kUniform) return false;
    const StoredGas& own = field_->values_[values.first];
    if (first == nullptr) first = &own;
    if (own != *first) return false;
  }
  return true;
}

void PlumeFieldMaker::build_cells() {
  const bool linear = reading_.interpolation == PlumeInterpolation::kLinear;
  const BlockTree values(origin_);
  std::vector<Cell> cells;
  for (std::size_t b = 0; b < origin_.size(); ++b) {
    for (unsigned n = 0; n < (linear ? 8U : 1U); ++n) {
      const bool x = (n & 4) != 0, y = (n & 2) != 0, z = (n & 1) != 0;
      if (n != 0 && !reaches_back(field_->value_blocks_[b].gas, x, y, z)) continue;
      const Cell& at = origin_[b];
      cells.push_back({at[0] - (x ? 8 : 0), at[1] - (y ? 8 : 0), at[2] - (z ? 8 : 0)});
    }
  }
  std::sort(cells.begin(), cells.end(), BlockTree::before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  field_->cells_ = BlockTree(cells);
  field_->cell_origin_ = cells;
  field_->cell_blocks_.resize(cells.size());
  BlockTree::Cursor cursor;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    PlumeField::CellBlock& block = field_->cell_blocks_[c];
    block.values.fill(-1);
    for (unsigned n = 0; n < (linear ? 8U : 1U); ++n) {
      const Cell at{cells[c][0] + static_cast<int>(n & 4) * 2,
                    cells[c][1] + static_cast<int>(n & 2) * 4,
                    cells[c][2] + static_cast<int>(n & 1) * 8};
      block.values[n] = static_cast<std::int32_t>(values.find(at, cursor).block);
    }
    if (linear) {
      build_filled(block);
    } else {
      block.filled = field_->value_blocks_[static_cast<std::size_t>(block.values[0])].gas;
    }
    block.uniform = is_uniform(block);
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PlumeField::Box& box = field_->bounds_;
  box.low.fill(kInfinity);
  box.high.fill(-kInfinity);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (unsigned v = 0; v < 512; ++v) {
      if (!holds(field_->cell_blocks_[c].filled, v)) continue;
      const unsigned at[] = {v >> 6, v >> 3 & 7, v & 7};
      for (std::size_t a = 0; a < 3; ++a) {
        const double low = static_cast<double>(cells[c][a]) + at[a] - (linear ? 0 : 0.5);
        box.low[a] = std::min(box.low[a], low);
        box.high[a] = std::max(box.high[a], low + 1);
      }
    }
}

void PlumeFieldMaker::build_points() {
  constexpr std::array<double, 2> kLambdaUm = {4.3, 10};
  constexpr double kMuch = 1e-4;  // of all
  double edge_m = 0;
  for (const std::array<double, 3> axis :
       {std::array{1.0, 0.0, 0.0}, std::array{0.0, 1.0, 0.0}, std::array{0.0, 0.0, 1.0}})
    edge_m = std::max(edge_m,
                      length(field_->body_from_index(axis) - field_->body_from_index({0, 0, 0})));
  // Each group of 2^3 voxels.
  const auto for_each_group = [&](auto visit) {
    for (std::size_t c = 0; c < field_->cell_blocks_.size(); ++c) {
      const PlumeField::CellBlock& block = field_->cell_blocks_[c];
      if (block.values[0] < 0) continue;  // its own voxels hold no gas
      for (unsigned n = 0; n < 64; ++n) {
        const unsigned x = (n >> 4) * 2, y = (n >> 2 & 3) * 2, z = (n & 3) * 2;
        const Cell& origin = field_->cell_origin_[c];
        PlumePoint group;
        std::array<PlumePoint, 8> voxel;
        for (unsigned k = 0; k < 8; ++k) {
          const unsigned i = x + (k >> 2), j = y + (k >> 1 & 1), l = z + (k & 1);
          const GasSums gas = field_->at_voxel(block, i, j, l);
          voxel[k].at = field_->body_from_index({static_cast<double>(origin[0]) + i,
                                                 static_cast<double>(origin[1]) + j,
                                                 static_cast<double>(origin[2]) + l});
          voxel[k].reach_m = static_cast<float>(edge_m);
          group.at = group.at + 0.125 * voxel[k].at;
          if (!(gas.weight > 0)) continue;
          voxel[k].amount_mol = static_cast<float>(gas.weight * field_->voxel_volume_m3_);
          group.amount_mol += voxel[k].amount_mol;
          for (std::size_t m = 0; m < kLambdaUm.size(); ++m) {
            voxel[k].thin_w[m] = static_cast<float>(
                gas.weight * field_->voxel_volume_m3_ *
                planck_radiance_w_m2_sr_um(kLambdaUm[m], gas.weight_temperature / gas.weight));
            group.thin_w[m] += voxel[k].thin_w[m];
          }
        }
        group.reach_m = static_cast<float>(1.5 * edge_m);
        if (group.thin_w[0] > 0 || group.thin_w[1] > 0) visit(group, voxel);
      }
    }
  };
  std::array<double, 2> all{};
  for_each_group([&](const PlumePoint& group, const std::array<PlumePoint, 8>&) {
    for (std::size_t m = 0; m < all.size(); ++m) all[m] += static_cast<double>(group.thin_w[m]);
  });
  for_each_group([&](const PlumePoint& group, const std::array<PlumePoint, 8>& voxel) {
    bool much = false;
    for (std::size_t m = 0; m < all.size(); ++m)
      much |= static_cast<double>(group.thin_w[m]) > kMuch * all[m];
    if (much)
      field_->points_.insert(field_->points_.end(), voxel.begin(), voxel.end());
    else
      field_->points_.push_back(group);
  });
}

}  // namespace irsig
