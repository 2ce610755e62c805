#include "view/report/temperatures.h"

#include <set>
#include <string>

#include "core/base/status_macros.h"
#include "view/base/table.h"
#include "view/query/query.h"

namespace irsig {

absl::Status write_temperatures(StoreReader& reader, const TemperatureFilter& filter,
                                std::string_view format, std::ostream& out) {
  ASSIGN_OR_RETURN(const auto rows, reader.computed_temperatures(filter));
  if (rows.empty() || filter.season.names().size() > 1) {
    ASSIGN_OR_RETURN(const auto any, reader.computed_temperatures({}));
    if (any.empty())
      return absl::NotFoundError("no job has computed temperatures of a sweep in this database");
    std::set<std::string> seasons;  // also of earlier versions of a sweep
    for (const StoredTemperature& t : any) seasons.insert(t.season);
    RETURN_IF_ERROR(check_seasons(filter.season, seasons));
    if (rows.empty()) return absl::NotFoundError("no computed temperatures match the filters");
  }
  const std::vector<Column> columns = {{"sweep"},     {"season"},  {"time_utc"},
                                       {"part"},      {"mean_k"},  {"coldest_k"},
                                       {"hottest_k"}, {"error_k"}, {"superseded", false}};
  ASSIGN_OR_RETURN(const auto table, make_table_writer(format, columns, out));
  for (const StoredTemperature& t : rows)
    table->row({t.sweep, t.season, t.time_utc, t.part, t.mean_k, t.coldest_k, t.hottest_k,
                t.error_k, t.superseded});
  return table->finish();
}

}  // namespace irsig
