#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/ordered_dot.h"
#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {
namespace {

// Returns the corners of a mean place: {near, high} each.
std::array<std::array<double, 2>, 4> place_corners(const MeanPlace& place) {
  return {{{place.near.low, place.high.low},
           {place.near.low, place.high.high},
           {place.near.high, place.high.low},
           {place.near.high, place.high.high}}};
}

// Returns what the air changes at the corners of a mean place.
//   end  [3] of target_ends()
std::vector<IncidentRadiance::AirChange> changes_at(
    std::span<const IncidentRadiance::AirChange> end, const MeanPlace& place) {
  std::vector<IncidentRadiance::AirChange> out;
  for (const auto& [near, high] : place_corners(place)) {
    const auto between = [&](std::vector<double> IncidentRadiance::AirChange::*of) {
      const std::vector<double>&top = end[0].*of, &below = end[1].*of, &far = end[2].*of;
      std::vector<double> sum(far);
      for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += near * (below[i] - far[i]) + high * (top[i] - below[i]);
      return sum;
    };
    out.push_back({between(&IncidentRadiance::AirChange::transmittance),
                   between(&IncidentRadiance::AirChange::path_thermal),
                   between(&IncidentRadiance::AirChange::path_solar)});
  }
  return out;
}

}  // namespace

// The air is that in front of one place of the target. In front of another all that is added up to
// the apparent radiance, sum_s w_s R_s T + P with sum_s w_s = 1 but for the sun, changes by
//   | sum_s w_s (R_s dT + dP) |  <=  sum_s w_s |R_s dT + dP|,
// where dT and dP are linear between those of the target's ends, and the light of a source leaves
// the target in mean at a known place between them. (docs/explanation/methods.md)
ThreeBounds target_depth_bound(const BoundInput& in) {
  const ConditionSources& light = *in.row.light;
  const ViewEnvironment& e = light.environment();
  if (in.places == nullptr || e.end.empty()) return {};
  const SeenPlaces& places = *in.places;
  const SummedWeights& mean = in.mean;
  const SourceLayout& layout = in.setup.sources.layout();
  const std::size_t n = in.setup.scene.axis.node_um().size();
  const BandOnAxis& band = in.row.on_axis;
  const SpectralBasis* basis = in.setup.scene.path_basis();
  std::vector<double> most(n);
  const std::size_t columns = mean.columns;
  const double* of_nodes = mean.row(layout.first_sky());
  const IncidentRadiance& around = light.around();
  const std::vector<IncidentRadiance::AirChange> of_reflected =
      changes_at(e.end_change, places.reflected());
  double sum = basis == nullptr
                   ? around.changed(of_reflected, band.first_node, band.grid.band_weight,
                                    {of_nodes, around.count()})
                   : around.changed(of_reflected, band.first_node, band.grid.band_weight,
                                    [&](std::uint32_t node, std::span<double> w) {
                                      const double* of_node = of_nodes + node * columns;
                                      if (std::all_of(of_node, of_node + columns,
                                                      [](double x) { return x == 0; }))
                                        return false;
                                      basis->to_nodes(of_node, band.first_node, w);
                                      return true;
                                    });
  const auto add = [&](SourceId id, const MeanPlace& place, bool radiance) {
    const std::span<const double> of_source = light.radiance(id);
    const auto corner = place_corners(place);
    for (std::size_t i = band.first_node; i < band.first_node + band.nodes(); ++i) {
      const auto change = [&](const AirPath& end) {
        return of_source[i] * (end.transmittance[i] - e.transmittance[i]) +
               (radiance ? end.path_radiance_w_m2_sr_um[i] - e.path_radiance[i] : 0);
      };
      const double top = change(e.end[0]), below = change(e.end[1]), far = change(e.end[2]);
      most[i] = 0;
      for (const auto& [near, high] : corner)
        most[i] = std::max(most[i], std::abs(far + near * (below - far) + high * (top - below)));
    }
    sum += nodes_w_sr(most, basis, band, mean.row(id));
  };
  for (const SourceId id : layout.emitted())
    add(id, light.by_element() ? places.any_emitted() : places.emitted(index_of(id)), true);
  for (const SourceId id : layout.all_emitted())
    if (!layout.emitted().contains(id)) add(id, places.reflected(), true);
  for (const auto& of_cause : light.causes())
    for (const SourceRange range : of_cause)
      for (const SourceId id : range)
        if (!layout.without_sun().contains(id)) add(id, places.reflected(), false);
  // Add the part of the silhouette from which nothing is known to come.
  const BandGrid& grid = band.grid;
  double weighed = 0, width_um = 0, lost = 0;
  const SourceTable unit = unit_table(basis, band.first_node, grid.band_weight);
  for (const double w : grid.band_weight) width_um += w;
  for (const SourceId id : layout.without_sun())
    weighed +=
        width_um * ordered_dot(unit.source.data(), mean.row(id) + unit.first_column, unit.columns);
  for (std::size_t i = 0; i < band.nodes(); ++i) {
    double change = 0;
    for (const AirPath& end : e.end)
      change = std::max(change, std::abs(end.path_radiance_w_m2_sr_um[band.first_node + i] -
                                         e.path_radiance[band.first_node + i]));
    lost += grid.band_weight[i] * change;
  }
  if (width_um > 0) sum += std::abs(in.front_area_m2 - weighed / width_um) * lost;
  return {0, sum, sum};
}

}  // namespace irsig
