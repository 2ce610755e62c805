#include "core/land/height_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace irsig {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Steps below 1e-20 cells for each length of the direction move no ray of 1e9 lengths by 1e-11
// cells.
double step(double direction, double spacing_m) {
  const double out = direction / spacing_m;
  return std::abs(out) < 1e-20 ? 0.0 : out;
}

// The part of [begin, end] where 0 <= start + t step <= cells.
bool clip_axis(double start, double step, int cells, double& begin, double& end) {
  if (step == 0) return start >= 0 && start <= cells;
  double enter = -start / step, leave = (cells - start) / step;
  if (enter > leave) std::swap(enter, leave);
  begin = std::max(begin, enter);
  end = std::min(end, leave);
  return begin <= end;
}

// The cell at a coordinate, among [first, last).
int cell_at(double coordinate, int first, int last) {
  return std::clamp(static_cast<int>(coordinate), first, last - 1);
}

}  // namespace

HeightWalk::HeightWalk(const HeightTile& tile, Vec<Enu> origin_m, Vec<Enu> direction,
                       double bend_per_m)
    : tile_(tile),
      origin_m_(origin_m),
      direction_(direction),
      bend_per_m_(bend_per_m),
      x_((origin_m.x - tile.grid().west_m) / tile.grid().spacing_m),
      y_((origin_m.y - tile.grid().south_m) / tile.grid().spacing_m),
      z_(origin_m.z - bend_per_m * (origin_m.x * origin_m.x + origin_m.y * origin_m.y)),
      dx_(step(direction.x, tile.grid().spacing_m)),
      dy_(step(direction.y, tile.grid().spacing_m)),
      dz_(direction.z - 2 * bend_per_m * (origin_m.x * direction.x + origin_m.y * direction.y)),
      curve_(bend_per_m * (direction.x * direction.x + direction.y * direction.y)),
      across_(std::sqrt(direction.x * direction.x + direction.y * direction.y)),
      inverse_dx_(dx_ == 0 ? 0 : 1 / dx_),
      inverse_dy_(dy_ == 0 ? 0 : 1 / dy_),
      inverse_dz_(dz_ == 0 ? 0 : 1 / dz_) {}

bool HeightWalk::clip(double& begin, double& end) const {
  return clip_axis(x_, dx_, tile_.columns(), begin, end) &&
         clip_axis(y_, dy_, tile_.rows(), begin, end);
}

HeightWalk::Exit HeightWalk::exit_of(const CellBlock& block) const {
  const double at_x =
      dx_ == 0 ? kInfinity : ((dx_ > 0 ? block.east : block.west) - x_) * inverse_dx_;
  const double at_y =
      dy_ == 0 ? kInfinity : ((dy_ > 0 ? block.north : block.south) - y_) * inverse_dy_;
  return at_x <= at_y ? Exit{at_x, true} : Exit{at_y, false};
}

CellBlock HeightWalk::block_at(int level) const {
  const int bits = HeightTile::kBits * level, column = column_ >> bits, row = row_ >> bits;
  return {column << bits, std::min((column + 1) << bits, tile_.columns()), row << bits,
          std::min((row + 1) << bits, tile_.rows())};
}

// Moves the ray forward to t in this block. No step goes back, whatever rounding does.
void HeightWalk::place_at(double t, const CellBlock& within) {
  t_ = t;
  column_ = column_at(t, within);
  row_ = row_at(t, within);
}

int HeightWalk::column_at(double t, const CellBlock& within) const {
  const bool east = dx_ >= 0;
  return cell_at(x_ + t * dx_, east ? column_ : within.west, east ? within.east : column_ + 1);
}

int HeightWalk::row_at(double t, const CellBlock& within) const {
  const bool north = dy_ >= 0;
  return cell_at(y_ + t * dy_, north ? row_ : within.south, north ? within.north : row_ + 1);
}

// Returns true if the ray stays on its side of all of the block's heights. Otherwise moves it to
// where it reaches them.
bool HeightWalk::clear_of(const CellBlock& block, int level, double t_exit) {
  const int bits = HeightTile::kBits * level;
  const HeightRange range = tile_.range(level, block.west >> bits, block.south >> bits);
  const double bound_m = side_ > 0 ? range.highest : range.lowest;
  // Between two places a bent ray may be nearer than at either, by so much at most.
  const double step = t_exit - t_, sag_m = 0.25 * step * step * std::max(0.0, -side_ * curve_);
  const double here = side_ * (z_m(t_) - bound_m);
  if (here <= sag_m) return false;
  const double there = side_ * (z_m(t_exit) - bound_m);
  if (there > sag_m) return true;
  if (sag_m > 0) return false;
  // The straight line between both places reaches the bound before the bent ray does.
  const double reached =
      curve_ == 0 ? (bound_m - z_) * inverse_dz_ : t_ + step * (here / (here - there));
  if (reached > t_ && reached < t_exit) place_at(reached, block);
  return false;
}

// Returns true if the ray, which is above the surface here, rises more steeply than all of the
// block's triangles until it leaves the block.
bool HeightWalk::outclimbs(const CellBlock& block, int level, double t_exit) const {
  constexpr double kMargin = 1e-6;  // of a slope: far above rounding
  const int bits = HeightTile::kBits * level;
  const double rise = dz_ - 2 * (curve_ > 0 ? t_exit : t_) * curve_;
  const auto steepest =
      static_cast<double>(tile_.steepest(level, block.west >> bits, block.south >> bits));
  return rise > (steepest + kMargin) * across_;
}

double HeightWalk::clearance_m(double t, LandTriangle triangle) const {
  const float* south = tile_.corner(column_, row_);
  const float* north = south + tile_.columns() + 1;
  const double u = std::clamp(x_ + t * dx_ - column_, 0.0, 1.0);
  const double v = std::clamp(y_ + t * dy_ - row_, 0.0, 1.0);
  const double southwest = south[0], northeast = north[1];
  const double middle = triangle == LandTriangle::kSoutheast ? south[1] : north[0];
  const double first = triangle == LandTriangle::kSoutheast ? u : v;
  const double second = triangle == LandTriangle::kSoutheast ? v : u;
  return z_m(t) - (southwest + first * (middle - southwest) + second * (northeast - middle));
}

double HeightWalk::clearance_m(double t) const {
  HeightWalk here = *this;
  here.column_ = cell_at(x_ + t * dx_, 0, tile_.columns());
  here.row_ = cell_at(y_ + t * dy_, 0, tile_.rows());
  const bool southeast = x_ + t * dx_ - here.column_ >= y_ + t * dy_ - here.row_;
  return here.clearance_m(t, southeast ? LandTriangle::kSoutheast : LandTriangle::kNorthwest);
}

// The clearance is linear in t within each triangle, but for the ray's bend: the ray is followed
// from its entry over the diagonal to its exit.
std::optional<Crossing> HeightWalk::cross_cell(double t_exit) const {
  const auto crossing = [&](double begin, double end,
                            LandTriangle triangle) -> std::optional<Crossing> {
    const double before = side_ * clearance_m(begin, triangle);
    const double after = side_ * clearance_m(end, triangle);
    if (before < 0) return Crossing{begin, false, column_, row_, triangle};
    if (after >= 0) return std::nullopt;
    const double t = begin + (end - begin) * (before / (before - after));
    return Crossing{t, false, column_, row_, triangle};
  };
  const auto east_of_diagonal = [&](double t) {
    return (x_ + t * dx_ - column_) - (y_ + t * dy_ - row_);
  };
  const double at_entry = east_of_diagonal(t_), at_exit = east_of_diagonal(t_exit);
  const auto triangle = [](double east) {
    return east >= 0 ? LandTriangle::kSoutheast : LandTriangle::kNorthwest;
  };
  if (at_entry * at_exit >= 0) return crossing(t_, t_exit, triangle(at_entry + at_exit));
  const double at_diagonal =
      std::clamp(t_ + (t_exit - t_) * (at_entry / (at_entry - at_exit)), t_, t_exit);
  if (const auto hit = crossing(t_, at_diagonal, triangle(at_entry))) return hit;
  return crossing(at_diagonal, t_exit, triangle(at_exit));
}

// Steps over the side of a block to the next cell; false: that is beyond the map.
bool HeightWalk::advance(const CellBlock& from, const Exit& exit) {
  t_ = exit.t;
  if (exit.along_x) {
    row_ = row_at(t_, from);
    column_ = dx_ > 0 ? from.east : from.west - 1;
  } else {
    column_ = column_at(t_, from);
    row_ = dy_ > 0 ? from.north : from.south - 1;
  }
  return column_ >= 0 && row_ >= 0 && column_ < tile_.columns() && row_ < tile_.rows();
}

std::optional<Crossing> HeightWalk::first_crossing(double begin, double end, double side,
                                                   const HeightInset* inset, bool starts_above) {
  side_ = side;
  t_ = begin;
  column_ = cell_at(x_ + begin * dx_, 0, tile_.columns());
  row_ = cell_at(y_ + begin * dy_, 0, tile_.rows());
  int level = tile_.top();
  while (true) {
    CellBlock block = block_at(level);
    const bool replaced = level == 0 && inset != nullptr && inset->cells.contains(column_, row_);
    if (replaced) block = inset->cells;
    const Exit exit = exit_of(block);
    const double t_exit = std::clamp(exit.t, t_, end);
    if (level > 0) {
      if (!(starts_above && outclimbs(block, level, t_exit)) && !clear_of(block, level, t_exit)) {
        --level;
        continue;
      }
    } else if (replaced) {
      HeightWalk inner(*inset->tile, origin_m_, direction_, bend_per_m_);
      if (auto hit = inner.first_crossing(t_, t_exit, side, nullptr)) {
        hit->inset = true;
        return hit;
      }
    } else if (const auto hit = cross_cell(t_exit)) {
      return hit;
    }
    if (!(exit.t < end)) return std::nullopt;
    const int column = column_, row = row_, bits = HeightTile::kBits * (level + 1);
    if (!advance(block, {t_exit, exit.along_x})) return std::nullopt;
    const bool left_parent = ((column ^ column_) >> bits) != 0 || ((row ^ row_) >> bits) != 0;
    if (left_parent && level < tile_.top()) ++level;
  }
}

}  // namespace irsig
