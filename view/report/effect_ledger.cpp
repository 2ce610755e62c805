#include "view/report/effect_ledger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace irsig {
namespace {

std::string percent_of(double part, double whole) {
  if (std::isnan(part) || !(std::abs(whole) > 0)) return "-";
  const double size = 100 * part / std::abs(whole);
  // 140 rather than 1.4e+02.
  return std::abs(size) >= 100 && std::abs(size) < 1e6 ? fmt::format("{:.0f} %", size)
                                                       : fmt::format("{:.2g} %", size);
}

std::string ledger_seconds(double time_s) {
  if (time_s == 0) return "0";
  if (time_s < 1e-3) return fmt::format("{:.2g} us", 1e6 * time_s);
  return time_s < 1 ? fmt::format("{:.3g} ms", 1e3 * time_s) : fmt::format("{:.3g} s", time_s);
}

std::string time_of(const StoredEffect& e) {
  if (std::isnan(e.time_s)) return "-";
  return (e.state == "off" ? "saved " : "") + ledger_seconds(e.time_s);
}

// The largest of the bounds, each relative to the intensity where it applies.
double relative_bound(const StoredSignature& s, const StoredEffect& e) {
  const double source = e.bound_w_sr / std::abs(s.intensity_w_sr);
  const double aperture =
      std::max(e.apparent_bound_w_sr, e.contrast_bound_w_sr) / std::abs(s.apparent_intensity_w_sr);
  return std::isnan(source + aperture) ? kNotComputed : std::max(source, aperture);
}

}  // namespace

std::string_view reason_in_words(std::string_view reason) {
  if (reason == "always") return "never left out unasked";
  if (reason == "not_in_scene") return "nothing in this scene and condition causes it";
  if (reason == "within_fraction") return "the error asked for has room for its bound";
  if (reason == "above_fraction") return "the error asked for has no room for its bound";
  if (reason == "other_row") return "another row of the view needs it";
  if (reason == "no_goal") return "no relative error was asked for that says what is small";
  if (reason == "not_worth") return "so little could be left out that it does not pay to find out";
  if (reason == "unbounded") return "no finite bound is known";
  if (reason == "not_asked") return "on unless effects.without names it";
  if (reason == "forced") return "forced: the user's word";
  return reason;
}

std::string ledger_table(const StoredSignature& row, const std::vector<StoredEffect>& ledger) {
  if (ledger.empty()) return "";
  std::string out = fmt::format("{:<23} {:<6} {:>9} {:>9} {:>9} {:>9} {:>13}  {}\n", "effect", "",
                                "bound", "apparent", "contrast", "share", "time", "why");
  for (const StoredEffect& e : ledger) {
    const bool absent = e.state == "absent";
    const auto bound = [&](double w_sr, double whole) {
      return absent ? std::string("-") : percent_of(w_sr, whole);
    };
    out += fmt::format("{:<23} {:<6} {:>9} {:>9} {:>9} {:>9} {:>13}  {}\n", e.effect, e.state,
                       bound(e.bound_w_sr, row.intensity_w_sr),
                       bound(e.apparent_bound_w_sr, row.apparent_intensity_w_sr),
                       bound(e.contrast_bound_w_sr, row.contrast_intensity_w_sr),
                       percent_of(e.fraction_w_sr, row.intensity_w_sr), time_of(e),
                       std::string(reason_in_words(e.reason)));
  }
  return out;
}

std::vector<EffectSummary> summarize_effects(std::span<const LedgerRow> rows) {
  std::vector<EffectSummary> out;
  // An entry's time is that of its whole view: the rows of a view state it again and again.
  using View = std::tuple<std::string, double, double, double>;
  std::map<std::tuple<View, std::string, std::string>, double> time_s;  // by effect and state
  for (const LedgerRow& row : rows) {
    const StoredSignature& s = row.signature;
    const View view{s.sweep, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m};
    for (const StoredEffect& e : row.ledger.effect) {
      auto at = std::find_if(out.begin(), out.end(),
                             [&](const EffectSummary& known) { return known.effect == e.effect; });
      if (at == out.end()) {
        at = out.emplace(out.end());
        at->effect = e.effect;
      }
      if (e.state == "absent") {
        ++at->absent;
        continue;
      }
      ++at->reason[e.reason];
      if (!std::isnan(e.time_s)) {
        double& largest = time_s[{view, e.effect, e.state}];
        largest = std::max(largest, e.time_s);
      }
      if (e.state == "on") {
        ++at->on;
        continue;
      }
      // One bound that is not known makes the largest unknown.
      const double bound = relative_bound(s, e);
      at->largest_bound =
          at->off++ == 0 || std::isnan(bound) ? bound : std::max(bound, at->largest_bound);
    }
  }
  for (const auto& [of, seconds] : time_s) {
    const auto& [view, effect, state] = of;
    const auto at = std::find_if(out.begin(), out.end(), [name = effect](const EffectSummary& e) {
      return e.effect == name;
    });
    double& sum = state == "off" ? at->saved_s : at->spent_s;
    sum = std::isnan(sum) ? seconds : sum + seconds;
  }
  return out;
}

std::string summary_table(const std::vector<EffectSummary>& summary) {
  std::string out =
      fmt::format("{:<23} {:>7} {:>7} {:>7} {:>13} {:>10} {:>10}  {}\n", "effect", "on", "off",
                  "absent", "largest bound", "spent", "saved", "why (rows)");
  for (const EffectSummary& e : summary) {
    std::vector<std::string> reasons;
    for (const auto& [reason, rows] : e.reason)
      reasons.push_back(fmt::format("{} ({})", std::string(reason_in_words(reason)), rows));
    out += fmt::format(
        "{:<23} {:>7} {:>7} {:>7} {:>13} {:>10} {:>10}  {}\n", e.effect, e.on, e.off, e.absent,
        std::isnan(e.largest_bound) ? "-" : fmt::format("{:.2g} %", 100 * e.largest_bound),
        std::isnan(e.spent_s) ? "-" : ledger_seconds(e.spent_s),
        std::isnan(e.saved_s) ? "-" : ledger_seconds(e.saved_s), fmt::join(reasons, "; "));
    out.erase(out.find_last_not_of(" \n") + 1);
    out += "\n";
  }
  return out;
}

}  // namespace irsig
