#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/scene/mesh.h"
#include "core/thermal/scene/scene_heat.h"

namespace irsig {

// What the temperatures of facets say of their parts, and what facets without one have.

[[nodiscard]] std::vector<double> facet_areas_m2(const Mesh& mesh);

// Of one part at one output, over the facets that have a temperature.
struct PartTemperature {
  std::uint32_t part;
  std::size_t output;
  double mean_k, error_k;  // by area
  double coldest_k, hottest_k;
};
// Of each part whose facets have temperatures.
[[nodiscard]] std::vector<PartTemperature> part_temperatures(const Target& target,
                                                             const std::vector<double>& area_m2,
                                                             const SceneHeatResult& heat);

// Degenerate facets send nothing; so that each facet of a part that may be seen has a temperature,
// they have the part's mean.
void fill_degenerate(const Target& target, const std::vector<HeatPart>& part,
                     const std::vector<PartTemperature>& means, SceneHeatResult& heat);

// Degenerate facets change as the mean of their part does, as far as that is known; they send
// nothing.
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
