#include "planning/sweep_facets.h"

#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/status_macros.h"

namespace irsig {

absl::StatusOr<SweepFacets> SweepFacets::load(const std::string& database,
                                              const std::string& sweep) {
  ASSIGN_OR_RETURN(auto source, load_accuracy_source(database, sweep));
  SweepFacets out;
  out.source_ = std::move(source);
  const LoadedSweep& loaded = out.source_.loaded;
  ASSIGN_OR_RETURN(out.scene_, scene_from_sweep(loaded.resolved, loaded.assets, loaded.heat));
  ASSIGN_OR_RETURN(const auto of_groups, part_of_groups(out.scene_.mesh, out.scene_.part));
  for (const std::uint32_t group : out.scene_.mesh.triangle_group)
    out.part_.push_back(of_groups[group]);
  ASSIGN_OR_RETURN(out.fields_, facet_temperatures(loaded.resolved, loaded.assets, loaded.heat,
                                                   out.scene_.mesh, out.part_));
  return out;
}

absl::Status SweepFacets::check_seasons(const NameSet& season) const {
  std::set<std::string> known;
  for (const schema::Condition& c : sweep().condition()) known.insert(c.season());
  for (const std::string& name : season.names())
    if (!known.contains(name))
      return absl::NotFoundError(absl::StrCat(
          "no season \"", name, "\" in this sweep; there is: ", absl::StrJoin(known, ", ")));
  return absl::OkStatus();
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
