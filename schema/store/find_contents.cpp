#include "schema/store/find_contents.h"

#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

// Reads every row of a statement with `take`.
template <typename Take>
absl::Status each(absl::StatusOr<Rows> rows, const Take& take) {
  if (!rows.ok()) return rows.status();
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, rows->next());
    if (!found) return absl::OkStatus();
    take(*rows);
  }
}

double known(Rows& rows) {
  if (!rows.is_null()) return rows.real();
  (void)rows.text();  // the next column is read next
  return kNotComputed;
}

}  // namespace

absl::StatusOr<std::vector<SweepContents>> find_contents(Database& database) {
  std::vector<SweepContents> out;
  std::vector<std::int64_t> id;
  IRSIG_STORE_TRY(each(database.query(sql::contents_of_sweeps), [&](Rows& row) {
    id.push_back(row.integer());
    SweepContents& sweep = out.emplace_back();
    sweep.name = row.text();
    sweep.viewpoints = row.count();
    sweep.whole_rows = row.count();
    sweep.rows = row.count();
    sweep.thumbnails = row.integer() != 0;
    sweep.clutter = row.integer() != 0;
  }));
  for (std::size_t i = 0; i < out.size(); ++i) {
    IRSIG_STORE_TRY(each(database.query(sql::conditions_of_sweep, id[i]), [&](Rows& row) {
      SweepContents::Condition& condition = out[i].condition.emplace_back();
      condition.season = row.text();
      condition.time_utc = row.text();
    }));
    IRSIG_STORE_TRY(each(database.query(sql::bands_of_sweep, id[i]), [&](Rows& row) {
      SweepContents::Band& band = out[i].band.emplace_back();
      band.name = row.text();
      band.lambda_min_um = row.real();
      band.lambda_max_um = row.real();
    }));
    IRSIG_STORE_TRY(each(database.query(sql::ranges_of_sweep, id[i]),
                         [&](Rows& row) { out[i].range_m.push_back(row.real()); }));
  }
  return out;
}

absl::StatusOr<std::vector<StoredValue>> find_values(Database& database,
                                                     const ValueFilter& filter) {
  std::vector<StoredValue> out;
  IRSIG_STORE_TRY(
      each(database.query(sql::values_of_signatures, filter.sweep, filter.season, filter.time_utc,
                          filter.band, filter.range_m, static_cast<int>(filter.quantity)),
           [&](Rows& row) {
             StoredValue value{};
             value.row = row.count();
             value.aspect_azimuth_deg = row.real();
             value.aspect_elevation_deg = row.real();
             value.value = known(row);
             value.value_stderr = known(row);
             value.numerical_error = known(row);
             if (out.empty() || out.back().row != value.row) out.push_back(value);
           }));
  return out;
}

}  // namespace irsig
