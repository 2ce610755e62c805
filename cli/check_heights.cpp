#include "cli/check_heights.h"

#include <algorithm>
#include <array>

#include "absl/strings/match.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/land/check_heights.h"
#include "core/land/read_heights.h"
#include "fmt/format.h"
#include "view/base/table.h"

namespace irsig {
namespace {

std::string heights_json(const std::string& file, const HeightRaster& raster,
                         const HeightReport& report) {
  const auto odd = [](const OddSamples& samples) {
    std::string out = fmt::format("{{\"count\": {}", samples.count);
    if (samples.count > 0)
      out += fmt::format(", \"first_row\": {}, \"first_column\": {}", samples.row + 1,
                         samples.column + 1);
    return out + "}";
  };
  return fmt::format(
      "{{\"file\": {}, \"columns\": {}, \"rows\": {}, \"spacing_m\": {:.9g}, \"lowest_m\": {:.9g}, "
      "\"highest_m\": {:.9g}, \"missing\": {}, \"spikes\": {}, \"beyond_land\": {}}}\n",
      json_string(file), raster.columns, raster.rows, report.spacing_m, report.lowest_m,
      report.highest_m, odd(report.missing), odd(report.spikes), report.beyond_land);
}

std::string heights_text(const std::string& file, const HeightRaster& raster,
                         const HeightReport& report) {
  std::string out = fmt::format(
      "{}: {} x {} samples, about {:.6g} m apart, heights {:.6g} to {:.6g} m\n", one_line(file),
      raster.columns, raster.rows, report.spacing_m, report.lowest_m, report.highest_m);
  const auto first = [](const OddSamples& samples) {
    return fmt::format("the first in row {}, column {}", samples.row + 1, samples.column + 1);
  };
  if (report.missing.count > 0)
    out += fmt::format(
        "error   missing heights: {}, {}; land.fill_m of a sweep states a height for them\n",
        report.missing.count, first(report.missing));
  if (report.beyond_land)
    out +=
        "error   heights beyond all land (-440 to 8849 m); multiply them by 0.3048 if they are in "
        "feet\n";
  if (report.spikes.count > 0)
    out += fmt::format(
        "warning spikes: {}, {}, with {:.6g} m; correct samples that no neighbour supports\n",
        report.spikes.count, first(report.spikes), report.spikes.height_m);
  if (report.missing.count + report.spikes.count == 0 && !report.beyond_land)
    out += "nothing found\n";
  return out;
}

}  // namespace

bool is_heights_file(const std::string& file) {
  constexpr std::array kEndings{".hgt", ".asc", ".tif", ".tiff"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](const char* ending) { return absl::EndsWithIgnoreCase(file, ending); });
}

absl::StatusOr<int> check_heights_file(const std::string& file, const OutputOptions& output) {
  const auto bytes = read_user_file(file, kMostModelBytes);
  if (!bytes.ok())
    return absl::InvalidArgumentError(
        fmt::format("{}: {}", one_line(file), std::string(bytes.status().message())));
  ASSIGN_OR_RETURN(const auto raster, read_heights(*bytes, file));
  const HeightReport report = check_heights(raster);
  RETURN_IF_ERROR(output.write([&](std::string_view format, std::ostream& out) {
    out << (format == "json" ? heights_json(file, raster, report)
                             : heights_text(file, raster, report))
        << std::flush;
    return absl::OkStatus();
  }));
  return report.missing.count > 0 || report.beyond_land ? 2 : 0;
}

}  // namespace irsig
