#include "view/bands/merit.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace irsig {
namespace {
constexpr std::pair<std::string_view, Merit> kMerits[] = {{"mean", Merit::kMean},
                                                          {"percentile", Merit::kPercentile},
                                                          {"worst", Merit::kWorst},
                                                          {"above", Merit::kAbove},
                                                          {"range", Merit::kRange}};
}  // namespace

std::optional<Merit> merit_named(std::string_view name) {
  for (const auto& [known, merit] : kMerits)
    if (known == name) return merit;
  return std::nullopt;
}

std::string_view name_of(Merit merit) {
  for (const auto& [name, known] : kMerits)
    if (known == merit) return name;
  return "";
}

double merit_of(const MeritOf& merit, std::span<const double> weight, std::span<const double> snr) {
  switch (merit.merit) {
    case Merit::kMean: {
      double sum = 0;
      for (std::size_t i = 0; i < snr.size(); ++i) sum += weight[i] * snr[i];
      return sum;
    }
    case Merit::kWorst:
      return *std::min_element(snr.begin(), snr.end());
    case Merit::kAbove: {
      double sum = 0;
      for (std::size_t i = 0; i < snr.size(); ++i)
        if (snr[i] >= merit.threshold) sum += weight[i];
      return sum;
    }
    case Merit::kPercentile:
    case Merit::kRange: {
      // The first, in their order, up to which the weights reach the share: by halves.
      std::vector<std::pair<double, double>> of(snr.size());
      for (std::size_t i = 0; i < snr.size(); ++i) of[i] = {snr[i], weight[i]};
      const double share = 0.01 * merit.percentile * (1 - 1e-12);
      auto first = of.begin(), last = of.end();
      for (double before = 0; last - first > 1;) {
        const auto middle = first + (last - first) / 2;
        std::nth_element(first, middle, last);
        double sum = before;
        for (auto at = first; at != middle; ++at) sum += at->second;
        if (sum >= share) {
          last = middle;
        } else {
          before = sum;
          first = middle;
        }
      }
      return first->first;
    }
  }
  return 0;
}

}  // namespace irsig
