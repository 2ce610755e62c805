#include "core/land/check_heights.h"

#include <algorithm>
#include <cmath>

#include "core/land/choose_map.h"

namespace irsig {
namespace {

constexpr double kHighestLandM = 8849, kLowestLandM = -440;  // Mount Everest, the Dead Sea's shore
constexpr double kSpikeSamples = 2, kSpikeM = 30;

void add(OddSamples& to, std::uint32_t column, std::uint32_t row, double height_m) {
  if (to.count++ == 0) to = {1, column, row, height_m};
}

bool is_spike(const HeightRaster& raster, std::uint32_t column, std::uint32_t row, double least_m) {
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return raster.height_m[std::size_t{j} * raster.columns + i];
  };
  const float height_m = at(column, row);
  int above = 0, below = 0, neighbours = 0;
  for (std::uint32_t j = row - std::min(row, 1U); j <= std::min(row + 1, raster.rows - 1); ++j)
    for (std::uint32_t i = column - std::min(column, 1U);
         i <= std::min(column + 1, raster.columns - 1); ++i) {
      if ((i == column && j == row) || std::isnan(at(i, j))) continue;
      ++neighbours;
      above += height_m - at(i, j) > least_m ? 1 : 0;
      below += at(i, j) - height_m > least_m ? 1 : 0;
    }
  return neighbours >= 3 && (above == neighbours || below == neighbours);
}

}  // namespace

HeightReport check_heights(const HeightRaster& raster) {
  HeightReport out;
  out.spacing_m = spacing_of(raster);
  const double spike_m = std::max(kSpikeM, kSpikeSamples * out.spacing_m);
  bool any = false;
  for (std::uint32_t row = 0; row < raster.rows; ++row)
    for (std::uint32_t column = 0; column < raster.columns; ++column) {
      const double height_m = raster.height_m[std::size_t{row} * raster.columns + column];
      if (std::isnan(height_m)) {
        add(out.missing, column, row, height_m);
        continue;
      }
      out.lowest_m = any ? std::min(out.lowest_m, height_m) : height_m;
      out.highest_m = any ? std::max(out.highest_m, height_m) : height_m;
      any = true;
      if (is_spike(raster, column, row, spike_m)) add(out.spikes, column, row, height_m);
    }
  out.beyond_land = out.highest_m > kHighestLandM || out.lowest_m < kLowestLandM;
  return out;
}

}  // namespace irsig
