#include "view/plot/plot_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

std::string key_of(const StoredSignature& s) {
  return fmt::format("{}\n{}\n{}\n{}", s.sweep, s.season, s.time_utc, s.range_m);
}

// Room that a text takes: DejaVu Sans is 0.6 em wide on average.
double text_width(const std::string& text, double size) {
  const auto characters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  });
  return 0.6 * size * static_cast<double>(characters);
}

constexpr double kSize = 14, kSample = 34, kGap = 26;  // of legends

double line_width(const std::vector<LegendEntry>& entries, std::size_t first, std::size_t last) {
  double total = -kGap;
  for (std::size_t i = first; i < last; ++i)
    total += kSample + 8 + text_width(entries[i].name, kSize) + kGap;
  return total;
}

}  // namespace

CurveNames::CurveNames(const std::vector<StoredSignature>& signatures) {
  std::set<std::string> sweeps;
  std::set<double> ranges;
  std::map<std::string, std::set<std::string>> times;
  for (const auto& s : signatures) {
    if (std::find(key_.begin(), key_.end(), key_of(s)) == key_.end()) key_.push_back(key_of(s));
    sweeps.insert(s.sweep);
    ranges.insert(s.range_m);
    times[s.sweep + '\n' + s.season].insert(s.time_utc);
  }
  several_sweeps_ = sweeps.size() > 1;
  several_ranges_ = ranges.size() > 1;
  several_times_ =
      std::any_of(times.begin(), times.end(), [](const auto& t) { return t.second.size() > 1; });
}

std::string CurveNames::name(const StoredSignature& s) const {
  std::string out = several_sweeps_ ? fmt::format("{} {}", s.sweep, s.season) : s.season;
  if (several_times_) {
    // "2025-12-21T01:30:00Z" -> "01:30Z"
    const bool full = s.time_utc.size() >= 16;
    out += " " + (full ? s.time_utc.substr(11, 5) + "Z" : s.time_utc);
  }
  if (several_ranges_) out += ", " + range_title(s.range_m).substr(6);
  return out;
}

std::size_t CurveNames::index(const StoredSignature& s) const {
  return static_cast<std::size_t>(std::find(key_.begin(), key_.end(), key_of(s)) - key_.begin());
}

std::string band_title(const StoredSignature& s) {
  const std::string limits =
      fmt::format("{:g}\u2013{:g} \u00b5m", s.lambda_min_um, s.lambda_max_um);
  return s.band == limits ? limits : fmt::format("{} ({})", s.band, limits);
}

std::string range_title(double range_m) {
  return range_m >= 1000 ? fmt::format("range {:g} km", range_m / 1000)
                         : fmt::format("range {:g} m", range_m);
}

std::string range_title(const std::vector<StoredSignature>& signatures) {
  for (const StoredSignature& s : signatures)
    if (s.range_m != signatures.front().range_m) return "";
  return ", " + range_title(signatures.front().range_m);
}

absl::StatusOr<std::vector<StoredSignature>> signatures_to_plot(StoreReader& reader,
                                                                const Query& query,
                                                                const ExtentOf& extent_of) {
  ASSIGN_OR_RETURN(auto rows, run_query(reader, query, extent_of));
  if (rows.empty()) return absl::NotFoundError("nothing to plot: no signature matches the filters");
  std::vector<StoredSignature> out;
  std::set<std::string> sweeps;
  std::set<double> ranges;
  for (QueryRow& r : rows) {
    sweeps.insert(r.signature.sweep);
    ranges.insert(r.range_change ? r.range_change->stored_range_m : r.signature.range_m);
    out.push_back(std::move(r.signature));
  }
  if (sweeps.size() > 1) {
    return absl::InvalidArgumentError(fmt::format(
        "a plot shows one sweep; choose one with --sweep: {}", fmt::join(sweeps, ", ")));
  }
  RETURN_IF_ERROR(check_computed(out, query.quantity));
  if (ranges.size() > 1) {
    return absl::InvalidArgumentError(
        fmt::format("a plot shows one range, and these signatures have {}: {} m; choose one with "
                    "--at-range-m",
                    ranges.size(), fmt::join(ranges, ", ")));
  }
  return out;
}

int legend_entries_per_line(const std::vector<LegendEntry>& entries, double width) {
  for (std::size_t n = entries.size(); n > 1; --n) {
    double widest = 0;
    for (std::size_t first = 0; first < entries.size(); first += n)
      widest = std::max(widest, line_width(entries, first, std::min(entries.size(), first + n)));
    if (widest <= width) return static_cast<int>(n);
  }
  return 1;
}

void draw_legend(Svg& svg, Point top_center, const std::vector<LegendEntry>& entries,
                 int per_line) {
  constexpr double kLine = 22;
  const auto n = static_cast<std::size_t>(per_line);
  for (std::size_t first = 0; first < entries.size(); first += n) {
    const std::size_t last = std::min(entries.size(), first + n);
    double x = top_center.x - line_width(entries, first, last) / 2;
    const double y = top_center.y + kLine * static_cast<double>(first / n);
    for (std::size_t i = first; i < last; ++i) {
      svg.line({x, y}, {x + kSample, y}, entries[i].stroke);
      svg.text({x + kSample + 8, y + 0.35 * kSize}, entries[i].name, {.size = kSize});
      x += kSample + 8 + text_width(entries[i].name, kSize) + kGap;
    }
  }
}

}  // namespace irsig
