#include "view/report/outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>

#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

constexpr const char* kRemedy =
    "set two_sided = true for parts that are sheets, mend facets that are inside out with `irsig "
    "model check FILE --repair OUT.obj`";

// What decides an error, and how a sweep file lowers it.
struct Limit {
  std::string_view name, remedy;
  auto operator<=>(const Limit&) const = default;
};
constexpr std::string_view kRaiseLimit = "raise [accuracy] max_samples_per_replicate";
constexpr Limit kSamples{"scatter of the samples",
                         "ask for a smaller relative_error, which plans more samples"};
constexpr Limit kUnmet{"small bright facets that samples may miss",
                       "make them a [[part]] of their own with hot = true, or ask for a smaller "
                       "relative_error, which plans more samples"};

std::string_view remedy_of(BoundOf bound) {
  switch (bound) {
    case BoundOf::kTruncation:
      return "raise [transport] max_reflections";
    case BoundOf::kQuadrature:
      return "set step_um of the [[band]] smaller";
    case BoundOf::kUnseen:
      return kUnmet.remedy;
    case BoundOf::kOmitted:
      return "run with --effects all";
    case BoundOf::kTemperature:
      return "set [heat] element_size_m smaller, or state better temperatures";
    case BoundOf::kPlume:
    case BoundOf::kBasis:
    case BoundOf::kSky:
    case BoundOf::kDepth:
    case BoundOf::kBackground:
    case BoundOf::kMoved:
      break;
  }
  return "no key lowers it: ask for a larger relative_error";
}

// Returns the largest part of a row's numerical error. More samples lower what samples leave open,
// and only that.
Limit limit_of(const StoredSignature& row) {
  const Measured source = source_of(row);
  Limit out = kSamples;
  double most = source.sampled_fraction();
  const auto see = [&](double share, const Limit& limit) {
    if (!(share > most)) return;
    most = share;
    out = limit;
  };
  see(source.unseen_fraction(), kUnmet);
  for (std::size_t i = 0; i < kBounds; ++i) {
    const auto which = static_cast<BoundOf>(i);
    see(source.share(which), {info_of(which).name, remedy_of(which)});
  }
  const bool of_samples = out == kSamples || out.remedy == kUnmet.remedy;
  if (of_samples && row.stop_reason == "sample_limit") out.remedy = kRaiseLimit;
  return out;
}

// Numbers of rows that did not reach their accuracy, by what decides their error.
using Limits = std::map<Limit, std::uint64_t>;

void count_limit(const StoredSignature& row, Limits& limits) {
  if (!row.superseded &&
      (row.stop_reason == "accuracy_not_reached" || row.stop_reason == "sample_limit"))
    ++limits[limit_of(row)];
}

// Returns the most frequent first.
std::vector<std::string> notes_of(const Limits& limits) {
  std::vector<std::pair<Limit, std::uint64_t>> sorted(limits.begin(), limits.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<std::string> out;
  for (const auto& [limit, rows] : sorted)
    out.push_back(fmt::format("{} row{} short of the accuracy by: {}; {}", rows,
                              rows == 1 ? " falls" : "s fall", limit.name, limit.remedy));
  return out;
}

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

std::vector<std::string> limit_notes(const std::vector<StoredSignature>& rows) {
  Limits limits;
  for (const StoredSignature& row : rows) count_limit(row, limits);
  return notes_of(limits);
}

absl::StatusOr<std::vector<std::string>> limit_notes(StoreReader& reader,
                                                     const std::string& sweep) {
  ASSIGN_OR_RETURN(const auto rows, QueryRows::open(reader, {.sweep = sweep}));
  Limits limits;
  for (;;) {
    ASSIGN_OR_RETURN(const auto some, rows->next());
    if (some.empty()) return notes_of(limits);
    for (const QueryRow& row : some) count_limit(row.signature, limits);
  }
}

std::string image_text(const StoredOutcome& outcome, const schema::Image& image) {
  const double percent = 100 * outcome.image_error_relative;
  std::string text;
  if (image.has_pixel_error_percent() && percent > image.pixel_error_percent())
    text = fmt::format("{:.2g} % in the worst case, {:g} %", percent, image.pixel_error_percent());
  else if (image.has_pixel_error_k() && outcome.image_error_k > image.pixel_error_k())
    text = fmt::format("{:.2g} K in the worst case, {:g} K", outcome.image_error_k,
                       image.pixel_error_k());
  if (text.empty()) return text;
  return fmt::format("pixels are known to {} was asked for; raise [image] max_samples", text);
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
