#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>

#include "core/base/status_macros.h"
#include "serve/answer_parts.h"
#include "view/plot/plot.h"
#include "view/query/query_table.h"

namespace irsig {
namespace {

constexpr const char* kCsv = "text/csv; charset=utf-8";
constexpr const char* kSvg = "image/svg+xml";
constexpr const char* kPng = "image/png";
constexpr const char* kExr = "image/x-exr";

using Bytes = absl::StatusOr<std::string>;

Bytes table(const PageSources& sources, const Question& q, const Query& query, bool spectrum) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(auto rows, run_query(*reader, query, sources.extent_of));
  if (rows.empty()) return absl::NotFoundError("no signature matches");
  std::ostringstream out;
  QueryContent content;
  content.spectrum = spectrum;
  content.causes = query.row.has_value();
  content.quantity = query.quantity;
  RETURN_IF_ERROR(write_rows(*reader, rows, content, "csv", out));
  return out.str();
}

Bytes rows_csv(const PageSources& sources, const Question& q) {
  return table(sources, q, selection_query(q.a, q.quantity), false);
}
Bytes row_csv(const PageSources& sources, const Question& q) {
  return table(sources, q, row_query(q), false);
}
Bytes spectrum_csv(const PageSources& sources, const Question& q) {
  return table(sources, q, row_query(q), true);
}

Bytes cut_csv(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  std::ostringstream out;
  RETURN_IF_ERROR(
      write_polar(*reader, selection_query(q.a, q.quantity), q.elevation_deg, "csv", out));
  return out.str();
}

Bytes compare_csv(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto compared, compare_selections(sources, q));
  std::ostringstream out;
  RETURN_IF_ERROR(write_comparison(compared, columns_of(q.quantity), "csv", out));
  return out.str();
}

Bytes map_svg(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  return plot_map(*reader, selection_query(q.a, q.quantity));
}
Bytes cut_svg(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  return plot_polar(*reader, selection_query(q.a, q.quantity), q.elevation_deg);
}
Bytes spectrum_svg(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  // plot_spectrum has no way to move a row; a picture of another range than asked would be wrong.
  if (q.range_m)
    return absl::InvalidArgumentError(
        "a spectrum at another range is not drawn as a file: take its CSV");
  return plot_spectrum(*reader, row_query(q));
}

Bytes image_png(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(auto image, answer_thumbnail(sources, q));
  return std::move(image.body);
}

Bytes image_exr(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(auto image, answer_image_exr(sources, q));
  return std::move(image.body);
}

struct File {
  std::string_view name;
  const char* type;
  Needs needs;
  Bytes (*bytes)(const PageSources&, const Question&);
};

constexpr File kFiles[] = {
    {"rows.csv", kCsv, Needs::kSelection, rows_csv},
    {"row.csv", kCsv, Needs::kRow, row_csv},
    {"spectrum.csv", kCsv, Needs::kRow, spectrum_csv},
    {"cut.csv", kCsv, Needs::kSelection, cut_csv},
    {"compare.csv", kCsv, Needs::kBoth, compare_csv},
    {"bands.csv", kCsv, Needs::kBands, bands_csv},
    {"bands.svg", kSvg, Needs::kBands, bands_svg},
    {"left_out.csv", kCsv, Needs::kSelection, left_out_csv},
    {"image.png", kPng, Needs::kRow, image_png},
    {"image.exr", kExr, Needs::kImage, image_exr},
    {"map.svg", kSvg, Needs::kSelection, map_svg},
    {"cut.svg", kSvg, Needs::kSelection, cut_svg},
    {"spectrum.svg", kSvg, Needs::kRow, spectrum_svg},
};

}  // namespace

absl::StatusOr<PageReply> answer_file(const PageSources& sources, const std::string& file,
                                      const Parameters& parameters) {
  for (const File& f : kFiles) {
    if (f.name != file) continue;
    ASSIGN_OR_RETURN(const auto question,
                     parse_question(parameters, f.needs, sources.database.size()));
    ASSIGN_OR_RETURN(auto bytes, f.bytes(sources, question));
    return PageReply{200, f.type, std::move(bytes), file};
  }
  return absl::NotFoundError("there is no such file here");
}

}  // namespace irsig
