#include "planning/export_temperatures.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "planning/sweep_facets.h"
#include "runner/heat_model_error.h"
#include "runner/sweep_temperatures.h"
#include "view/base/table.h"

namespace irsig {

absl::Status export_temperatures(const std::string& database, const std::string& sweep_name,
                                 const NameSet& season, const std::string& time,
                                 std::ostream& out) {
  std::string time_utc;
  if (!time.empty()) {
    ASSIGN_OR_RETURN(const auto parsed, parse_rfc3339(time));
    time_utc = format_rfc3339_utc(parsed);
  }
  ASSIGN_OR_RETURN(const auto facets, SweepFacets::load(database, sweep_name));
  RETURN_IF_ERROR(facets.check_seasons(season));
  const schema::ResolvedSweep& sweep = facets.sweep();
  const std::vector<std::uint32_t>& part = facets.part();
  ASSIGN_OR_RETURN(const auto mesh, field_mesh(sweep, facets.source().loaded.assets));
  // [condition] Of those without, empty.
  std::vector<std::vector<double>> model_error_k;
  bool of_model = false;
  for (const schema::Condition& condition : sweep.condition()) {
    ASSIGN_OR_RETURN(auto error_k, heat_model_error_k(sweep, facets.source().loaded.heat, condition,
                                                      part.size()));
    of_model = of_model || !error_k.empty();
    model_error_k.push_back(std::move(error_k));
  }
  std::vector<Column> columns = {{"season"}, {"time"}, {"part"},        {"facet"}, {"x"},
                                 {"y"},      {"z"},    {"temperature"}, {"error"}};
  if (of_model) columns.push_back({"temperature_model_error_k"});
  ASSIGN_OR_RETURN(const auto table, make_table_writer("csv", columns, out));
  // Nobody knows the temperature of a facet that nobody sees.
  const auto known = [](double value) { return std::isnan(value) ? Cell() : Cell(value); };
  bool any = false;
  for (int c = 0; c < sweep.condition_size(); ++c) {
    const schema::Condition& condition = sweep.condition(c);
    if (!season.admits(condition.season())) continue;
    if (!time_utc.empty() && condition.time_utc() != time_utc) continue;
    any = true;
    for (std::size_t f = 0; f < part.size(); ++f) {
      const SweepFacets::Temperature at = facets.temperature(c, f);
      const std::array<double, 3> place = mesh.centroid(f);
      std::vector<Cell> row = {condition.season(),
                               condition.time_utc(),
                               sweep.sweep().part(static_cast<int>(part[f])).name(),
                               std::uint64_t{f},
                               place[0],
                               place[1],
                               place[2],
                               known(at.kelvin),
                               known(at.error_k)};
      const std::vector<double>& of_facet = model_error_k[static_cast<std::size_t>(c)];
      if (of_model) row.push_back(of_facet.empty() ? Cell() : known(of_facet[f]));
      table->row(row);
    }
  }
  if (!any) return absl::NotFoundError("nothing to export: no condition matches the filters");
  return table->finish();
}

}  // namespace irsig
