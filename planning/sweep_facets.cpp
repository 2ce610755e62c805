#include "planning/sweep_facets.h"

#include <cmath>
#include <utility>

namespace irsig {

absl::StatusOr<SweepFacets> SweepFacets::load(const std::string& database,
                                              const std::string& sweep) {
  auto source = load_accuracy_source(database, sweep);
  if (!source.ok()) return source.status();
  SweepFacets out;
  out.source_ = *std::move(source);
  const LoadedSweep& loaded = out.source_.loaded;
  auto scene = scene_from_sweep(loaded.resolved, loaded.assets, loaded.heat);
  if (!scene.ok()) return scene.status();
  out.scene_ = *std::move(scene);
  const auto of_groups = part_of_groups(out.scene_.mesh, out.scene_.part);
  if (!of_groups.ok()) return of_groups.status();
  for (const std::uint32_t group : out.scene_.mesh.triangle_group)
    out.part_.push_back((*of_groups)[group]);
  auto fields =
      facet_temperatures(loaded.resolved, loaded.assets, loaded.heat, out.scene_.mesh, out.part_);
  if (!fields.ok()) return fields.status();
  out.fields_ = *std::move(fields);
  return out;
}

SweepFacets::Temperature SweepFacets::temperature(int condition, std::size_t facet) const {
  if (!fields_.empty()) {
    const FacetTemperatures& at = fields_[static_cast<std::size_t>(condition)];
    if (std::isinf(at.error_k[facet])) return {NAN, NAN};
    if (!std::isnan(at.kelvin[facet]))
      return {static_cast<double>(at.kelvin[facet]), static_cast<double>(at.error_k[facet])};
  }
  const auto part = static_cast<int>(part_[facet]);
  return {sweep().condition(condition).part_temperature_k(part), 0};
}

}  // namespace irsig
