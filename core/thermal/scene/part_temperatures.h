#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/scene/mesh.h"
#include "core/thermal/scene/scene_heat.h"

namespace irsig {

// Temperatures of parts from those of their facets, and temperatures of facets that got none.

[[nodiscard]] std::vector<double> facet_areas_m2(const Mesh& mesh);

// Temperatures of one part at one output, over the facets that have one.
struct PartTemperature {
  std::uint32_t part;
  std::size_t output;
  double mean_k, error_k;  // by area
  double coldest_k, hottest_k;
};
// Returns the temperatures of each part whose facets have some, at each output.
[[nodiscard]] std::vector<PartTemperature> part_temperatures(const Target& target,
                                                             const std::vector<double>& area_m2,
                                                             const SceneHeatResult& heat);

// Gives degenerate facets, which send nothing, the mean of their part, so that each facet that may be
// seen has a temperature.
void fill_degenerate(const Target& target, const std::vector<HeatPart>& part,
                     const std::vector<PartTemperature>& means, SceneHeatResult& heat);

// Gives degenerate facets the mean change of their part, 0 if none of its facets has one.
void fill_degenerate(const Target& target, const std::vector<HeatPart>& part,
                     std::vector<float>& change_k);

// Facets whose middle is under the surface and which rise above it, by more than a hundredth of
// their height.
struct SurfaceCrossing {
  std::size_t count = 0;
  double highest_m = 0;
};
[[nodiscard]] SurfaceCrossing surface_crossing(const Target& target,
                                               const std::vector<HeatPart>& part,
                                               double surface_z_m);

// Facets that nothing from outside reaches have no temperature: how many, and which is the first.
struct UnreachedFacets {
  std::size_t count = 0, first = 0;
};
[[nodiscard]] UnreachedFacets unreached_facets(const Target& target,
                                               const std::vector<HeatPart>& part,
                                               const SceneHeatResult& heat);

}  // namespace irsig
