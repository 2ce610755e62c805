#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace irsig {

// A merit of the signal-to-noise ratios s of the rows.
enum class Merit {
  kMean,
  kPercentile,  // the value that all but `percentile` % of the population exceed
  kWorst,
  kAbove,  // the share of the population with s >= threshold
  kRange   // up to where all but `percentile` % of the population have s >= threshold [m]
};
// Returns the merit named "mean", "percentile", "worst", "above" or "range". nullopt: the name is
// none of these.
[[nodiscard]] std::optional<Merit> merit_named(std::string_view name);
[[nodiscard]] std::string_view name_of(Merit merit);
inline constexpr std::string_view kRatio = "SNR", kRatioInClutter = "SCNR";

struct MeritOf {
  Merit merit = Merit::kMean;
  double percentile = 10, threshold = 5;
  std::string_view ratio = kRatio;  // the name of s
};

// Computes the merit of rows with these weights, which sum to 1. kRange: takes reached ranges in
// place of s.
[[nodiscard]] double merit_of(const MeritOf& merit, std::span<const double> weight,
                              std::span<const double> snr);

}  // namespace irsig
