#include <fmt/format.h>

#include <sstream>

#include "core/base/status_macros.h"
#include "serve/answer_parts.h"
#include "serve/command_line.h"
#include "serve/json_text.h"
#include "view/plot/plot_frame.h"
#include "view/report/refine_tables.h"

namespace irsig {
namespace {

// A page waits for an answer: 3.6 s for so many, 0.7 s for 191.
constexpr std::size_t kMostAspects = 1000;

absl::StatusOr<SignatureField> field_of(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(const auto values, values_of_selection(*reader, q.a, q.quantity));
  if (values.size() > kMostAspects)
    return absl::FailedPreconditionError(
        fmt::format("{} aspects are too many for a page ({} at most): {}", values.size(),
                    kMostAspects, left_out_command(sources.database[q.a.database], q)));
  ASSIGN_OR_RETURN(const auto rows,
                   signatures_to_plot(*reader, selection_query(q.a, q.quantity), {}));
  return fields_of(rows, q.quantity).front();
}

}  // namespace

absl::StatusOr<PageReply> answer_left_out(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto field, field_of(sources, q));
  ASSIGN_OR_RETURN(const auto left_out, leave_one_out(field, kind_of(q.quantity)));
  if (left_out.empty())
    return absl::FailedPreconditionError("no viewpoint is surrounded by others");
  std::vector<std::uint64_t> row;
  std::vector<double> interpolated, error, relative_deviation;
  for (const LeftOutViewpoint& l : left_out) {
    row.push_back(field.signature[l.sample].row);
    interpolated.push_back(l.interpolated);
    error.push_back(l.error);
    relative_deviation.push_back(l.relative_deviation);
  }
  JsonObject out;
  out.text("command", left_out_command(sources.database[q.a.database], q));
  out.counts("row", row);
  out.numbers("interpolated", interpolated);
  out.numbers("error", error);
  out.numbers("relative_deviation", relative_deviation);
  return json_reply(out.finish());
}

absl::StatusOr<std::string> left_out_csv(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto field, field_of(sources, q));
  std::ostringstream out;
  RETURN_IF_ERROR(write_left_out({&field, 1}, kind_of(q.quantity), "csv", out));
  return out.str();
}

}  // namespace irsig
