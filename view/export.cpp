#include "view/export.h"

#include <fmt/format.h>

#include <fstream>
#include <set>

#include "view/atomic_file.h"
#include "view/query_table.h"

namespace irsig {

namespace {

absl::StatusOr<std::vector<QueryRow>> rows_to_export(StoreReader& reader, const Query& query) {
  auto rows = run_query(reader, query);
  if (rows.ok() && rows->empty())
    return absl::NotFoundError("nothing to export: no signature matches the filters");
  return rows;
}

}  // namespace

absl::Status export_csv(StoreReader& reader, const Query& query, std::ostream& out) {
  const auto rows = rows_to_export(reader, query);
  if (!rows.ok()) return rows.status();
  return write_rows(reader, *rows, {.causes = true}, "csv", out);
}

absl::Status export_file(StoreReader& reader, const Query& query, std::string_view format,
                         const std::string& path) {
  if (format != "csv" && format != "netcdf" && format != "envi") {
    return absl::InvalidArgumentError(
        fmt::format("unknown format \"{}\": expected csv, netcdf or envi", format));
  }
  const auto rows = rows_to_export(reader, query);
  if (!rows.ok()) return rows.status();
  if (format == "netcdf") {
    if (query.interpolate) {
      return absl::InvalidArgumentError(
          "netcdf holds computed signatures only: export interpolated ones as csv");
    }
    std::set<std::string> sweeps;
    for (const QueryRow& r : *rows) sweeps.insert(r.signature.sweep);
    if (sweeps.size() > 1) {
      return absl::InvalidArgumentError(fmt::format(
          "a netcdf file holds one sweep; choose one with --sweep: {}", fmt::join(sweeps, ", ")));
    }
  }
  if (format == "envi") return write_envi(reader, *rows, query.quantity, path);
  return replace_file(path, [&](const std::string& beside) -> absl::Status {
    if (format == "netcdf") return write_netcdf(reader, *rows, beside);
    std::ofstream file(beside, std::ios::trunc);
    return write_rows(reader, *rows, {.causes = true}, "csv", file);
  });
}

}  // namespace irsig
