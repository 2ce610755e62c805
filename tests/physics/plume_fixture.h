#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/plume/gas_light.h"
#include "core/plume/march.h"
#include "core/plume/plume_field.h"

namespace irsig::plume_fixture {

// A voxel of a made volume: no gas where co2 is 0.
struct Gas {
  double temperature_k = 0, co2 = 0, h2o = 0;
};

// x forward, y starboard, z down: the body frame itself, so that places in tests are places in the
// file. Voxel (i, j, k) is centred at `size_m` times itself.
inline PlumeGrids grids(PlumeInterpolation interpolation) {
  PlumeGrids out;
  out.temperature = {"temperature", std::nullopt, "K"};
  out.pressure = {"", 101325.0, "Pa"};
  out.co2 = {"co2", std::nullopt, "1"};
  out.h2o = {"h2o", std::nullopt, "1"};
  out.co = {"", 0.0, "1"};
  out.soot = {"", 0.0, "1"};
  out.interpolation = interpolation;
  out.up_axis = "-z";
  out.forward_axis = "+x";
  return out;
}

inline std::array<double, 12> cubes(double size_m) {
  return {size_m, 0, 0, 0, 0, size_m, 0, 0, 0, 0, size_m, 0};
}

using Cell = std::array<std::int32_t, 3>;

// All voxels of [low, high], of which those with co2 > 0 are active.
inline VoxelVolume volume_of(Cell low, Cell high, const std::array<double, 12>& world_from_index,
                             const std::function<Gas(int, int, int)>& gas) {
  VoxelVolume out;
  out.world_from_index = world_from_index;
  out.channel = {"temperature", "co2", "h2o"};
  out.background = {0, 0, 0};
  VolumeWriter writer(out);
  std::vector<float> value(512 * 3);
  for (int x = low[0] & -8; x <= high[0]; x += 8)
    for (int y = low[1] & -8; y <= high[1]; y += 8)
      for (int z = low[2] & -8; z <= high[2]; z += 8) {
        VoxelMask mask{};
        for (int v = 0; v < 512; ++v) {
          const int i = x + (v >> 6), j = y + (v >> 3 & 7), k = z + (v & 7);
          if (i < low[0] || j < low[1] || k < low[2] || i > high[0] || j > high[1] || k > high[2])
            continue;
          const Gas g = gas(i, j, k);
          if (!(g.co2 > 0)) continue;
          mask[static_cast<std::size_t>(v >> 6)] |= std::uint64_t{1} << (v & 63);
          const auto at = static_cast<std::size_t>(3 * v);
          value[at] = static_cast<float>(g.temperature_k);
          value[at + 1] = static_cast<float>(g.co2);
          value[at + 2] = static_cast<float>(g.h2o);
        }
        writer.add({x, y, z}, {mask, mask, mask}, value);
      }
  return out;
}

inline std::shared_ptr<const PlumeField> field_of(VoxelVolume volume,
                                                  PlumeInterpolation interpolation) {
  auto field = plume_of(std::move(volume), grids(interpolation));
  if (!field.ok()) throw std::runtime_error(std::string(field.status().message()));
  return *std::move(field);
}

// Grey absorption of CO2 alone, [m2/mol].
inline GreyAbsorption grey_co2(double m2_mol) { return {{m2_mol, 0, 0, 0}}; }

inline GasLight light(const std::vector<GasSegment>& segments, const GreyAbsorption& grey,
                      const std::function<double(double)>& blackbody, double background = 0) {
  std::vector<double> depth;
  std::vector<SegmentSource> source;
  for (const GasSegment& s : segments) {
    depth.push_back(grey.optical_depth(s));
    source.push_back(segment_source(s, blackbody));
  }
  return light_through(depth, source, background);
}

inline double stated_error(const std::vector<GasSegment>& segments, const GreyAbsorption& grey,
                           const std::function<double(double)>& blackbody) {
  std::vector<double> depth, coarse_depth;
  std::vector<SegmentSource> source, coarse_source;
  for (const GasSegment& s : segments) {
    depth.push_back(grey.optical_depth(s));
    source.push_back(segment_source(s, blackbody));
  }
  const std::vector<CoarseStep> coarse = coarser(segments);
  for (const CoarseStep& c : coarse) {
    coarse_depth.push_back(grey.optical_depth(c.segment));
    coarse_source.push_back(segment_source(c.segment, blackbody));
  }
  return step_error(depth, source, coarse, coarse_depth, coarse_source);
}

// Nodes and weights of Gauss and Legendre on [0, 1].
struct Nodes {
  std::vector<double> at, weight;
};
inline Nodes legendre(int n) {
  Nodes out;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(M_PI * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      const double next = x - p1 / slope;
      if (std::abs(next - x) < 1e-16) break;
      x = next;
    }
    out.at.push_back(0.5 * (1 + x));
    out.weight.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return out;
}

}  // namespace irsig::plume_fixture
