#include "view/report/temperatures.h"

#include "core/base/status_macros.h"
#include "view/base/table.h"
#include "view/query/query.h"

namespace irsig {

absl::Status write_temperatures(StoreReader& reader, const TemperatureFilter& filter,
                                std::string_view format, std::ostream& out) {
  RETURN_IF_ERROR(check_seasons(reader, filter.season));
  ASSIGN_OR_RETURN(const auto rows, reader.computed_temperatures(filter));
  if (rows.empty()) {
    ASSIGN_OR_RETURN(const auto any, reader.computed_temperatures({}));
    return absl::NotFoundError(any.empty()
                                   ? "no job has computed temperatures of a sweep in this database"
                                   : "no computed temperatures match the filters");
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
