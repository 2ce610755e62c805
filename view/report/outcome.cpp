#include "view/report/outcome.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>

#include "core/base/printable.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr const char* kRemedy =
    "set two_sided = true for parts that are sheets, mend facets that are inside out with `irsig "
    "model check FILE --repair OUT.obj`";

}  // namespace

std::string stopped_text(const StoredOutcome& outcome, const schema::Accuracy& accuracy) {
  if (!accuracy.has_relative_error()) return "";
  std::uint64_t rows = 0, reached = 0;
  std::string others;
  for (const auto& [reason, count] : outcome.stop) {
    rows += count;
    if (reason == "accuracy_reached") {
      reached = count;
    } else if (reason == "floor_reached") {
      others += fmt::format(", {} only the floor of {:g} K (floor_reached)", count,
                            accuracy.absolute_error_k());
    } else {
      others += fmt::format(", {} do not ({})", count, reason);
    }
  }
  if (others.empty()) return "";
  return fmt::format("{} of {} rows reach {:g} %", reached, rows, 100 * accuracy.relative_error()) +
         others;
}

std::string backface_text(const StoredOutcome& outcome) {
  if (outcome.backface_views == 0) return "";
  return fmt::format(
      "back faces: seen from {} viewpoint{}, up to {:.3g} % of the silhouette are one-sided facets "
      "from behind, which send nothing: {}",
      outcome.backface_views, outcome.backface_views == 1 ? "" : "s",
      100 * outcome.largest_backface_fraction, kRemedy);
}

absl::StatusOr<std::vector<std::string>> floor_notes(StoreReader& reader,
                                                     const std::vector<QueryRow>& rows) {
  std::map<std::string, std::uint64_t> floor, all;
  for (const QueryRow& row : rows) {
    if (row.interpolation || row.signature.superseded) continue;
    ++all[row.signature.sweep];
    if (row.signature.stop_reason == "floor_reached") ++floor[row.signature.sweep];
  }
  std::vector<std::string> out;
  for (const auto& [sweep, count] : floor) {
    ASSIGN_OR_RETURN(const auto stored, reader.sweep(sweep, SweepFiles::kNone));
    const schema::Accuracy& accuracy = stored.resolved.sweep().accuracy();
    out.push_back(fmt::format(
        "{} of {} rows stopped at the floor of {:g} K, above the {:g} % that was asked for "
        "(floor_reached)",
        count, all[sweep], accuracy.absolute_error_k(), 100 * accuracy.relative_error()));
  }
  return out;
}

std::string slice_text(const schema::Slice& slice) {
  // A database may come from anywhere.
  return one_line(fmt::format(
      "sliced from {}: {} of {} rows, {}; sweep {}{}", slice.source(), slice.rows(),
      slice.source_rows(), slice.filter().empty() ? "all" : slice.filter(), slice.sweep_sha256(),
      slice.source_digest().empty() ? "" : ", digest " + slice.source_digest()));
}

}  // namespace irsig
