#include "view/report/outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>

#include "core/accuracy/measured.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr const char* kRemedy =
    "set two_sided = true for parts that are sheets, mend facets that are inside out with `irsig "
    "model check FILE --repair OUT.obj`";

// A part of a numerical error as column limiting_bound names it, in words, and how it is lowered.
struct Limit {
  std::string_view name, meaning, remedy;
};
constexpr std::string_view kRaiseLimit = "raise [accuracy] max_samples_per_replicate";
constexpr std::string_view kNoKey = "no key lowers it: ask for a larger relative_error";
constexpr auto kLimits = std::to_array<Limit>({
    {kLimitedBySampling, "scatter of the samples",
     "ask for a smaller relative_error, which plans more samples"},
    {"undersampling", "small bright facets that samples may miss",
     "make them a [[part]] of their own with hot = true, or ask for a smaller relative_error, "
     "which plans more samples"},
    {"truncation", "reflections after the last one", "raise [transport] max_reflections"},
    {"quadrature", "the integral over wavelength", "set step_um of the [[band]] smaller"},
    {"spectral_basis", "spectra between the wavelengths at which they are traced", kNoKey},
    {"direction_interpolation", "sky and sea between the directions at which they are known",
     kNoKey},
    {"omitted", "effects that are off", "run with --effects all"},
    {"temperature", "temperatures of large facets",
     "set [heat] element_size_m smaller, or state better temperatures"},
    {"plume", "steps along rays through hot gas", kNoKey},
});

}  // namespace

void LimitNotes::add(const StoredSignature& row) {
  if (row.superseded || row.limiting_bound.empty()) return;
  // More samples lower what samples leave open, and only that.
  const bool of_samples =
      row.limiting_bound == kLimitedBySampling || row.limiting_bound == "undersampling";
  ++rows_[{row.limiting_bound, of_samples && row.stop_reason == "sample_limit"}];
}

std::vector<std::string> LimitNotes::text() const {
  std::vector<std::pair<std::pair<std::string, bool>, std::uint64_t>> sorted(rows_.begin(),
                                                                             rows_.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<std::string> out;
  for (const auto& [limit, rows] : sorted)
    out.push_back(fmt::format("{} row{} not reach the accuracy: {}", rows,
                              rows == 1 ? " does" : "s do", limit_text(limit.first, limit.second)));
  return out;
}

std::string limit_text(std::string_view limiting_bound, bool at_sample_limit) {
  const auto* const found = std::find_if(kLimits.begin(), kLimits.end(),
                                         [&](const Limit& l) { return l.name == limiting_bound; });
  if (found == kLimits.end()) return one_line(std::string(limiting_bound));  // of another program
  return fmt::format("{} ({}); {}", found->meaning, found->name,
                     at_sample_limit ? kRaiseLimit : found->remedy);
}

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
  LimitNotes out;
  for (const StoredSignature& row : rows) out.add(row);
  return out.text();
}

absl::StatusOr<std::vector<std::string>> limit_notes(StoreReader& reader,
                                                     const std::string& sweep) {
  LimitNotes out;
  RETURN_IF_ERROR(reader.visit_errors(sweep, [&](const StoredSignature& row) { out.add(row); }));
  return out.text();
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
