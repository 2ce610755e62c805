#include "planning/export_temperatures.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "bridge/spec_to_request.h"
#include "core/geo/sun.h"
#include "planning/accuracy_source.h"
#include "view/table.h"

namespace irsig {

absl::Status export_temperatures(const std::string& database, const std::string& sweep_name,
                                 const std::string& season, const std::string& time,
                                 std::ostream& out) {
  std::string time_utc;
  if (!time.empty()) {
    const auto parsed = parse_rfc3339(time);
    if (!parsed.ok()) return parsed.status();
    time_utc = format_rfc3339_utc(*parsed);
  }
  const auto source = load_accuracy_source(database, sweep_name);
  if (!source.ok()) return source.status();
  const schema::ResolvedSweep& sweep = source->loaded.resolved;
  const auto scene = scene_from_sweep(sweep, source->loaded.assets, source->loaded.heat);
  if (!scene.ok()) return scene.status();
  const auto of_groups = part_of_groups(scene->mesh, scene->part);
  if (!of_groups.ok()) return of_groups.status();
  std::vector<std::uint32_t> part;
  for (const std::uint32_t group : scene->mesh.triangle_group) part.push_back((*of_groups)[group]);
  const auto fields =
      facet_temperatures(sweep, source->loaded.assets, source->loaded.heat, scene->mesh, part);
  if (!fields.ok()) return fields.status();
  const std::vector<Column> columns = {{"season"}, {"time"},        {"part"},
                                       {"facet"},  {"temperature"}, {"error"}};
  const auto table = make_table_writer("csv", columns, out);
  if (!table.ok()) return table.status();
  bool any = false;
  for (int c = 0; c < sweep.condition_size(); ++c) {
    const schema::Condition& condition = sweep.condition(c);
    if (!season.empty() && condition.season() != season) continue;
    if (!time_utc.empty() && condition.time_utc() != time_utc) continue;
    any = true;
    for (std::size_t f = 0; f < part.size(); ++f) {
      const auto p = static_cast<int>(part[f]);
      double kelvin = condition.part_temperature_k(p), error_k = 0;
      if (!fields->empty()) {
        const FacetTemperatures& at = (*fields)[static_cast<std::size_t>(c)];
        if (!std::isnan(at.kelvin[f])) {
          kelvin = static_cast<double>(at.kelvin[f]);
          error_k = static_cast<double>(at.error_k[f]);
        }
      }
      (*table)->row({condition.season(), condition.time_utc(), sweep.sweep().part(p).name(),
                     std::uint64_t{f}, kelvin, error_k});
    }
  }
  if (!any) return absl::NotFoundError("nothing to export: no condition matches the filters");
  return (*table)->finish();
}

}  // namespace irsig
