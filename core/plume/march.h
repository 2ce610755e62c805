#pragma once

#include <functional>
#include <vector>

#include "core/plume/gas_segments.h"
#include "core/plume/plume_field.h"

namespace irsig {

struct PlumeRay {
  Vec<Body> origin, direction;  // m; direction of length 1
  double start_m = 0, end_m = 0;
};

// Counts of the steps of a march, for benchmarks.
struct MarchCounts {
  std::uint64_t cells = 0;   // that hold gas
  std::uint64_t pieces = 0;  // cells and their halves
  std::uint64_t skips = 0;   // steps through what is empty, of 1 to 4096 voxels
};

// Returns the gas that a ray meets between start_m and end_m, from near to far, as a function of
// field, ray and steps alone.
//
// The ray goes through the tree of cells (block_tree.h) by steps of 4096, 128, 8 and 1; in a cell
// that holds gas amounts are cubic polynomials along it (kLinear) or constants, integrated exactly
// by Simpson's rule; only the temperature's course within a segment is approximated. A cell on
// whose face the ray lies belongs to the side of larger indices.
[[nodiscard]] std::vector<GasSegment> march(const PlumeField& field, const PlumeRay& ray,
                                            const SegmentSteps& steps,
                                            MarchCounts* counts = nullptr);

// Adds an interval of any gas: one step from start_m to end_m over `gas` at distances along the
// ray, halved as a cell is. Its amounts are as accurate as Simpson's rule.
void add_interval(const std::function<GasSums(double)>& gas, double start_m, double end_m,
                  const SegmentSteps& steps, SegmentBuilder& builder);

}  // namespace irsig
