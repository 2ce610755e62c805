#include "view/report/refine_tables.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "view/base/table.h"

namespace irsig {

std::vector<std::string> notes_on(const Refinement& found, std::span<const SignatureField> fields,
                                  SignatureQuantity quantity, double relative_error) {
  const auto share = [&](std::size_t above) {
    return 100 * static_cast<double>(above) / static_cast<double>(found.directions);
  };
  std::vector<std::string> out = {fmt::format(
      "{} viewpoints, {} fields of the {}: interpolation between them states up to {:.3g} % (one "
      "sigma); more than {:.3g} % at {:.3g} % of the directions",
      fields.front().signature.size(), fields.size(), columns_of(quantity).name,
      100 * found.largest_before, 100 * relative_error, share(found.above_before))};
  if (found.add.empty())
    out.emplace_back("no viewpoint is needed");
  else
    out.push_back(fmt::format(
        "with {} more it would state up to {:.3g} %, more than {:.3g} % at {:.3g} % of the "
        "directions{}",
        found.add.size(), 100 * found.largest_after, 100 * relative_error, share(found.above_after),
        found.above_after > 0 ? " (--most)" : ""));
  return out;
}

absl::Status write_proposed(const Refinement& found, std::span<const SignatureField> fields,
                            std::string_view format, std::ostream& out) {
  if (format == "text") {
    fmt::print(out, "# Viewpoints besides, of irsig plan --refine: for the end of [viewpoints]\n");
    for (const ProposedViewpoint& v : found.add) {
      const StoredSignature& s = fields[v.field].signature.front();
      fmt::print(out,
                 "[[viewpoints.aspect]]  # {:.2g} % in {} {}, {}\nazimuth_deg = {:.2f}\n"
                 "elevation_deg = {:.2f}\n",
                 100 * v.relative_error, one_line(s.season), s.time_utc, one_line(s.band),
                 v.azimuth_deg, v.elevation_deg);
    }
    return absl::OkStatus();
  }
  auto writer = make_table_writer(format,
                                  {{"aspect_azimuth_deg"},
                                   {"aspect_elevation_deg"},
                                   {"relative_error"},
                                   {"season"},
                                   {"time_utc"},
                                   {"band"}},
                                  out);
  if (!writer.ok()) return writer.status();
  for (const ProposedViewpoint& v : found.add) {
    const StoredSignature& s = fields[v.field].signature.front();
    (*writer)->row(
        {v.azimuth_deg, v.elevation_deg, v.relative_error, s.season, s.time_utc, s.band});
  }
  return (*writer)->finish();
}

absl::Status write_left_out(std::span<const SignatureField> fields, FieldKind kind,
                            std::string_view format, std::ostream& out) {
  auto writer = make_table_writer(format,
                                  {{"season"},
                                   {"time_utc"},
                                   {"band"},
                                   {"aspect_azimuth_deg"},
                                   {"aspect_elevation_deg"},
                                   {"value"},
                                   {"interpolated"},
                                   {"error"},
                                   {"relative_deviation"}},
                                  out);
  if (!writer.ok()) return writer.status();
  for (const SignatureField& field : fields) {
    ASSIGN_OR_RETURN(const auto left_out, leave_one_out(field, kind));
    for (const LeftOutViewpoint& l : left_out) {
      const StoredSignature& s = field.signature[l.sample];
      (*writer)->row({s.season, s.time_utc, s.band, s.aspect_azimuth_deg, s.aspect_elevation_deg,
                      l.value, l.interpolated, l.error, l.relative_deviation});
    }
  }
  return (*writer)->finish();
}

}  // namespace irsig
