#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/draw/svg.h"
#include "view/query/interpolate_rows.h"

namespace irsig {

// Shared parts of the plots: their curves and the names of curves.

// One legend has at most so many curves: more cannot be told apart.
inline constexpr std::size_t kMostCurves = 8;

// "winter", or "winter 01:30Z" if a season has more than one time, or with the sweep's name in
// front or the range behind it if there are several.
struct CurveNames {
  explicit CurveNames(const std::vector<StoredSignature>& signatures);
  [[nodiscard]] std::string name(const StoredSignature& s) const;
  // Returns the index of a signature's curve, in order of appearance.
  [[nodiscard]] std::size_t index(const StoredSignature& s) const;
  [[nodiscard]] std::size_t size() const { return key_.size(); }

 private:
  std::vector<std::string> key_;
  bool several_sweeps_ = false, several_times_ = false, several_ranges_ = false;
};

// Returns the title of a band, "3-5 (3 to 5 um)", or of a range.
[[nodiscard]] std::string band_title(const StoredSignature& s);
[[nodiscard]] std::string range_title(double range_m);
// Returns ", range 5 km". Empty: the signatures have several ranges, and the curves are named by
// them.
[[nodiscard]] std::string range_title(const std::vector<StoredSignature>& signatures);

// Returns the signatures of a plot: all requested ranges, otherwise one sweep and one stored range,
// since one picture shows one. NOT_FOUND: nothing matches. INVALID_ARGUMENT: several sweeps or
// stored ranges match.
[[nodiscard]] absl::StatusOr<std::vector<StoredSignature>> signatures_to_plot(
    StoreReader& reader, const Query& query, const ExtentOf& extent_of);

struct LegendEntry {
  std::string name;
  Stroke stroke;
};
// Returns the number of entries that fit side by side, at least 1.
[[nodiscard]] int legend_entries_per_line(const std::vector<LegendEntry>& entries, double width);
// Draws the entries side by side, centred at x. Each `per_line` entries take one line of 20 px.
void draw_legend(Svg& svg, Point top_center, const std::vector<LegendEntry>& entries, int per_line);

}  // namespace irsig
