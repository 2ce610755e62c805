#include "view/merit.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
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
      std::vector<std::size_t> order(snr.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::sort(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return snr[a] < snr[b]; });
      double sum = 0;
      for (const std::size_t i : order) {
        sum += weight[i];
        if (sum >= 0.01 * merit.percentile * (1 - 1e-12)) return snr[i];
      }
      return snr[order.back()];
    }
  }
  return 0;
}

}  // namespace irsig
