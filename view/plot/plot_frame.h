#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/draw/svg.h"
#include "view/query/interpolate_rows.h"

namespace irsig {

// Shared parts of the plots: their curves and the names of curves.

// "winter", or "winter 01:30Z" if a season has more than one time, or with the sweep's name in
// front or the range behind it if there are several.
struct CurveNames {
  explicit CurveNames(const std::vector<StoredSignature>& signatures);
  [[nodiscard]] std::string name(const StoredSignature& s) const;
  // The place of a signature's curve among all, in order of appearance.
  [[nodiscard]] std::size_t index(const StoredSignature& s) const;
  [[nodiscard]] std::size_t size() const { return key_.size(); }

 private:
  std::vector<std::string> key_;
  bool several_sweeps_ = false, several_times_ = false, several_ranges_ = false;
};

// "3-5 (3 to 5 um)"
[[nodiscard]] std::string band_title(const StoredSignature& s);
[[nodiscard]] std::string range_title(double range_m);
// ", range 5 km"; empty: of several, which the curves name.
[[nodiscard]] std::string range_title(const std::vector<StoredSignature>& signatures);

// The signatures of a plot. Errors: NOT_FOUND if nothing matches, INVALID_ARGUMENT if they are of
// several sweeps or stored ranges, since one picture shows one; of ranges that were asked for,
// all.
[[nodiscard]] absl::StatusOr<std::vector<StoredSignature>> signatures_to_plot(
    StoreReader& reader, const Query& query, const ExtentOf& extent_of);

struct LegendEntry {
  std::string name;
  Stroke stroke;
};
// Returns the number of entries that fit side by side, at least 1.
[[nodiscard]] int legend_entries_per_line(const std::vector<LegendEntry>& entries, double width);
// Side by side, centred at x; returns nothing: entries take one line of 20 px each `per_line`
// entries.
void draw_legend(Svg& svg, Point top_center, const std::vector<LegendEntry>& entries, int per_line);

}  // namespace irsig
