#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "core/base/status_macros.h"
#include "serve/answer_parts.h"
#include "serve/command_line.h"
#include "serve/json_text.h"
#include "view/draw/png.h"
#include "view/pictures/thumbnail.h"
#include "view/query/query_table.h"
#include "view/report/error_budget.h"
#include "view/report/explain.h"
#include "view/report/outcome.h"

namespace irsig {
namespace {

std::string budget_of(const QueryRow& row, SignatureQuantity quantity) {
  std::vector<std::string> parts;
  for (const ErrorPart& part : error_budget(row, columns_of(quantity))) {
    JsonObject out;
    out.text("name", part.name);
    out.text("what", part.what);
    out.flag("bound", part.bound);
    out.number("error", part.error_w_sr);
    out.number("share", part.share);
    parts.push_back(out.finish());
  }
  JsonObject all;
  all.objects("part", parts);
  return all.finish();
}

}  // namespace

absl::StatusOr<std::vector<QueryRow>> one_row(const PageSources& sources, StoreReader& reader,
                                              const Question& question) {
  ASSIGN_OR_RETURN(auto rows, run_query(reader, row_query(question), sources.extent_of));
  if (rows.empty())
    return absl::NotFoundError(fmt::format("sweep \"{}\" has no row {} (yet)", question.a.sweep,
                                           question.row.value_or(0)));
  return rows;
}

absl::StatusOr<PageReply> answer_row(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(const auto rows, one_row(sources, *reader, q));
  std::vector<std::string> notes = notes_on(rows);
  ASSIGN_OR_RETURN(const auto floors, floor_notes(*reader, rows));
  notes.insert(notes.end(), floors.begin(), floors.end());
  std::vector<std::string> limits = limit_notes({rows.front().signature});
  std::move(limits.begin(), limits.end(), std::back_inserter(notes));

  std::ostringstream signature, explained;
  QueryContent content;
  content.causes = true;
  RETURN_IF_ERROR(write_rows(*reader, rows, content, "json", signature));
  RETURN_IF_ERROR(explain_row(*reader, q.a.sweep, *q.row, "json", explained));

  const std::string& database = sources.database[q.a.database];
  const QuantityColumns& quantity = columns_of(q.quantity);
  const StoredSignature& stored = rows.front().signature;
  JsonObject out;
  out.text("command", row_command(database, q, false));
  out.text("explain_command", explain_command(database, q));
  out.text("image_command", image_command(database, q));
  out.text("quantity", quantity.name);
  out.text("title", quantity.title);
  out.text("unit", quantity.unit);
  out.number("value", stored.*quantity.value);
  out.number("value_stderr", stored.*quantity.value_stderr);
  out.number("numerical_error", stored.*quantity.numerical_error);
  out.texts("notes", notes);
  out.json("budget", budget_of(rows.front(), q.quantity));
  out.json("signature", signature.str());
  out.json("explained", explained.str());
  return json_reply(out.finish());
}

absl::StatusOr<PageReply> answer_spectrum(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(const auto rows, one_row(sources, *reader, q));
  ASSIGN_OR_RETURN(const auto got, spectrum_of(*reader, rows.front()));
  const schema::Spectrum& spectrum = got.spectrum;
  const QuantityColumns& quantity = columns_of(q.quantity);
  if ((spectrum.*quantity.spectral_value)().empty())
    return absl::FailedPreconditionError(fmt::format(
        "row {} has no spectrum of {}: an older irsig stored it", *q.row, quantity.value_name));
  const auto list = [](const auto& values) {
    return std::vector<double>(values.begin(), values.end());
  };
  JsonObject out;
  out.text("command", row_command(sources.database[q.a.database], q, true));
  out.text("title", quantity.spectral_title);
  out.text("unit", quantity.spectral_unit);
  out.numbers("lambda_um", list(spectrum.lambda_um()));
  out.numbers("value", list((spectrum.*quantity.spectral_value)()));
  out.numbers("value_stderr", list((spectrum.*quantity.spectral_stderr)()));
  for (const SpectralColumn& cause : spectral_causes())
    out.numbers(cause.name, list((spectrum.*cause.values)()));
  return json_reply(out.finish());
}

absl::StatusOr<PageReply> answer_thumbnail(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  Question stored = q;  // an image is of the stored range
  stored.range_m.reset();
  ASSIGN_OR_RETURN(const auto rows, one_row(sources, *reader, stored));
  ASSIGN_OR_RETURN(auto thumbnail, stored_thumbnail(*reader, rows));
  if (const std::string wrong = png_defect(thumbnail.png()); !wrong.empty())
    return absl::FailedPreconditionError(
        fmt::format("the stored image of row {} is damaged: {}", *q.row, wrong));
  return PageReply{200, "image/png", thumbnail.png(), ""};
}

}  // namespace irsig
