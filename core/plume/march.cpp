#include "core/plume/march.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/work_counts.h"
#include "core/plume/march_interval.h"

namespace irsig {
namespace {

using Cell = BlockTree::Cell;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A ray in the lattice of cells: cell i is [i, i + 1] along each axis. Distances stay in metres.
struct LatticeRay {
  std::array<double, 3> from, step, inverse;

  [[nodiscard]] double at(std::size_t a, double t) const { return from[a] + t * step[a]; }
  // Where it meets the plane at a whole number.
  [[nodiscard]] double meets(std::size_t a, double plane) const {
    return (plane - from[a]) * inverse[a];
  }
};

struct Span {
  double start, end;
};

// Returns the span in the box [low, high + 1] of cells; empty where start >= end.
Span inside(const LatticeRay& ray, const Cell& low, const Cell& high, Span span) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double l = low[a], h = static_cast<double>(high[a]) + 1;
    if (ray.step[a] == 0) {
      if (!(ray.from[a] >= l && ray.from[a] < h)) return {0, 0};
      continue;
    }
    const double t1 = ray.meets(a, l), t2 = ray.meets(a, h);
    span.start = std::max(span.start, std::min(t1, t2));
    span.end = std::min(span.end, std::max(t1, t2));
  }
  return span;
}

std::int32_t whole_in(double x, std::int32_t low, std::int32_t high) {
  return static_cast<std::int32_t>(
      std::clamp(std::floor(x), static_cast<double>(low), static_cast<double>(high)));
}

using StoredSums = std::array<double, std::tuple_size_v<StoredGas>>;

// Adds up the gas of a cell's corners with weights, all numbers of a corner side by side.
void add_weighted(const std::array<const StoredGas*, 8>& corner,
                  const std::array<double, 8>& weight, StoredSums& sum) {
  sum.fill(0);
  for (std::size_t n = 0; n < corner.size(); ++n) {
    const StoredGas& gas = *corner[n];
    const double share = weight[n], own = share * static_cast<double>(gas[0]);
    sum[0] += own;
    sum[1] += own * static_cast<double>(gas[1]);
    sum[2] += own * static_cast<double>(gas[2]);
    for (std::size_t i = 3; i < sum.size(); ++i) sum[i] += share * static_cast<double>(gas[i]);
  }
}

class Marcher {
 public:
  Marcher(const PlumeField& field, const PlumeRay& ray, const SegmentSteps& steps)
      : field_(field),
        steps_(steps),
        builder_(steps),
        linear_(field.interpolation() == PlumeInterpolation::kLinear) {
    // Distances count from a place near the gas: a far origin then costs no digits of steps.
    const PlumeField::Box box = field.bounds();
    std::array<double, 3> middle{};
    for (std::size_t a = 0; a < 3; ++a) middle[a] = 0.5 * (box.low[a] + box.high[a]);
    offset_m_ = dot(field.body_from_index(middle) - ray.origin, ray.direction);
    ray_.from = field.index_from_body(ray.origin + offset_m_ * ray.direction);
    ray_.step = field.index_direction(ray.direction);
    span_ = {ray.start_m - offset_m_, ray.end_m - offset_m_};
    for (std::size_t a = 0; a < 3; ++a) {
      if (!linear_) ray_.from[a] += 0.5;
      ray_.inverse[a] = ray_.step[a] == 0 ? kInfinity : 1 / ray_.step[a];
    }
  }

  std::vector<GasSegment> march(MarchCounts* counts) {
    struct Visit {
      Span span;
      const BlockTree::Root* root;
    };
    std::vector<Visit> visits;
    for (const BlockTree::Root& root : field_.cells().roots())
      if (const Span span = inside(ray_, root.low, root.high, span_); span.start < span.end)
        visits.push_back({span, &root});
    std::sort(visits.begin(), visits.end(),
              [](const Visit& a, const Visit& b) { return a.span.start < b.span.start; });
    for (const Visit& visit : visits) cross(*visit.root, visit.span);
    std::vector<GasSegment> out = builder_.take();
    count_work(Work::kGasSegments, out.size());
    for (GasSegment& segment : out) {
      segment.start_m += offset_m_;
      segment.end_m += offset_m_;
    }
    if (counts != nullptr) {
      counts->cells += counts_.cells;
      counts->pieces += counts_.pieces;
      counts->skips += counts_.skips;
    }
    return out;
  }

 private:
  // Leaves the aligned cube of `size` cells around the cell: the next cell, the distance there.
  // Cells only move forwards, whatever rounding says of places: so the march ends.
  double leave(Cell& cell, std::int32_t size, double t) const {
    double least = kInfinity;
    std::size_t axis = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (ray_.step[a] == 0) continue;
      const std::int32_t low = cell[a] & -size;
      const double exit = ray_.meets(a, ray_.step[a] > 0 ? static_cast<double>(low) + size : low);
      if (exit < least) {
        least = exit;
        axis = a;
      }
    }
    const double next = std::max(t, least);
    for (std::size_t a = 0; a < 3; ++a) {
      if (ray_.step[a] == 0) continue;
      const std::int32_t low = cell[a] & -size, high = low + (size - 1);
      const bool up = ray_.step[a] > 0;
      if (a == axis) {
        cell[a] = up ? high + 1 : low - 1;
      } else if (size > 1) {
        const std::int32_t at = whole_in(ray_.at(a, next), low, high);
        cell[a] = up ? std::max(cell[a], at) : std::min(cell[a], at);
      }
    }
    return next;
  }

  void cross(const BlockTree::Root& root, Span span) {
    Cell cell{};
    for (std::size_t a = 0; a < 3; ++a)
      cell[a] = whole_in(ray_.at(a, span.start), root.low[a], root.high[a]);
    const auto in_root = [&] {
      for (std::size_t a = 0; a < 3; ++a)
        if (cell[a] < root.low[a] || cell[a] > root.high[a]) return false;
      return true;
    };
    BlockTree::Cursor cursor;
    double t = span.start;
    while (t < span.end && in_root()) {
      const BlockTree::Found found = field_.cells().find(cell, cursor);
      if (found.block < 0) {
        ++counts_.skips;
        t = leave(cell, found.size, t);
      } else {
        t = cross_block(field_.cell_block(found.block), cell, t, span.end);
      }
    }
  }

  double cross_block(const PlumeField::CellBlock& block, Cell& cell, double t, double end) {
    const Cell origin{cell[0] & -8, cell[1] & -8, cell[2] & -8};
    const auto inside_block = [&] {
      return (cell[0] & -8) == origin[0] && (cell[1] & -8) == origin[1] &&
             (cell[2] & -8) == origin[2];
    };
    while (t < end && inside_block()) {
      const Cell in{cell[0] - origin[0], cell[1] - origin[1], cell[2] - origin[2]};
      const auto offset = static_cast<unsigned>(in[0] << 6 | in[1] << 3 | in[2]);
      const bool filled = holds(block.filled, offset);
      const Cell here = cell;
      const double next = leave(cell, block.uniform ? 8 : 1, t), stop = std::min(next, end);
      if (filled && stop > t) {
        cross_cell(block, here, in, t, stop);
      } else {
        ++counts_.skips;
      }
      t = next;
    }
    return t;
  }

  void cross_cell(const PlumeField::CellBlock& block, const Cell& cell, const Cell& in, double a,
                  double b) {
    ++counts_.cells;
    const auto x = static_cast<unsigned>(in[0]), y = static_cast<unsigned>(in[1]),
               z = static_cast<unsigned>(in[2]);
    if (!linear_ || block.uniform) {
      const GasSums gas = field_.at_voxel(block, x, y, z);
      const auto constant = [&](double) { return gas; };
      IntervalMarcher marcher(constant, steps_, builder_);
      at_end_ = GasPoint(gas);
      marcher.add(a, at_end_, b, at_end_);
      counts_.pieces += marcher.pieces();
      end_m_ = -kInfinity;  // the next cell has values of its own
      return;
    }
    find_corners(block, cell, x, y, z);
    const auto gas = [&](double t) { return between_corners(cell, t); };
    const GasPoint at_start = a == end_m_ ? at_end_ : GasPoint(gas(a));
    at_end_ = GasPoint(gas(b));
    end_m_ = b;
    IntervalMarcher marcher(gas, steps_, builder_);
    marcher.add(a, at_start, b, at_end_);
    counts_.pieces += marcher.pieces();
  }

  // The gas at the corners of a cell, whose place in its block is (x, y, z). Of a cell beside the
  // last one, four corners are known: they only change their numbers.
  void find_corners(const PlumeField::CellBlock& block, const Cell& cell, unsigned x, unsigned y,
                    unsigned z) {
    unsigned shared = 0, high = 0;
    int steps = has_corners_ ? 0 : 2;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int32_t step = cell[a] - corner_cell_[a];
      if (step == 0) continue;
      steps += step == 1 || step == -1 ? 1 : 2;
      shared = 4u >> a;
      high = step == 1 ? shared : 0;
    }
    // The common face is the low one of this cell after a step up, the high one after a step down.
    for (unsigned n = 0; n < 8; ++n)
      if (steps == 1 && (n & shared) != high) corner_[n] = corner_[n ^ shared];
    for (unsigned n = 0; n < 8; ++n)
      if (steps != 1 || (n & shared) == high)
        corner_[n] = &field_.stored(block, x + (n >> 2), y + (n >> 1 & 1), z + (n & 1));
    corner_cell_ = cell;
    has_corners_ = true;
  }

  GasSums between_corners(const Cell& cell, double t) const {
    double share[3];
    for (std::size_t a = 0; a < 3; ++a) share[a] = std::clamp(ray_.at(a, t) - cell[a], 0.0, 1.0);
    std::array<double, 8> weight;
    for (unsigned n = 0; n < 8; ++n)
      weight[n] = ((n & 4) != 0 ? share[0] : 1 - share[0]) *
                  ((n & 2) != 0 ? share[1] : 1 - share[1]) *
                  ((n & 1) != 0 ? share[2] : 1 - share[2]);
    StoredSums sum;
    add_weighted(corner_, weight, sum);
    return {sum[0], sum[1], sum[2], {sum[3], sum[4], sum[5], sum[6]}};
  }

  const PlumeField& field_;
  const SegmentSteps& steps_;
  SegmentBuilder builder_;
  const bool linear_;
  double offset_m_ = 0;
  LatticeRay ray_{};
  Span span_{};
  MarchCounts counts_;
  std::array<const StoredGas*, 8> corner_{};
  Cell corner_cell_{};  // whose corners they are
  bool has_corners_ = false;
  GasPoint at_end_;  // of the cell before, at end_m_
  double end_m_ = -kInfinity;
};

}  // namespace

std::vector<GasSegment> march(const PlumeField& field, const PlumeRay& ray,
                              const SegmentSteps& steps, MarchCounts* counts) {
  return Marcher(field, ray, steps).march(counts);
}

void add_interval(const std::function<GasSums(double)>& gas, double start_m, double end_m,
                  const SegmentSteps& steps, SegmentBuilder& builder) {
  IntervalMarcher(gas, steps, builder)
      .add(start_m, GasPoint(gas(start_m)), end_m, GasPoint(gas(end_m)));
}

}  // namespace irsig
