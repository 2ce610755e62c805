#include "core/materials/dhr_table.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace irsig {
namespace {

constexpr int kCoarsest = 256, kFinest = 16384;
constexpr double kChordError = 1e-5, kPole = 10;
constexpr double kGrazing = 0.0166;  // cos 89.05 deg

}  // namespace

double dhr_table_cos(int entry, int cells) {
  const double x = static_cast<double>(entry) / cells;
  return std::max(x * x, 1e-8);
}

DhrTable tabulate_dhr(std::size_t spectra,
                      const std::function<void(double, std::span<double>)>& dhr) {
  // Entries in units of the finest cell; those that are not computed lie on a chord.
  std::map<int, std::vector<double>> known;
  const auto compute = [&](int entry) -> const std::vector<double>& {
    auto& value = known[entry];
    if (value.empty()) {
      value.resize(spectra);
      dhr(dhr_table_cos(entry, kFinest), value);
    }
    return value;
  };
  int smallest = kFinest / kCoarsest;
  const std::function<void(int, int)> refine = [&](int from, int step) {
    if (step == 1) return;
    const std::vector<double>&a = compute(from), &b = compute(from + step);
    const std::vector<double>& middle = compute(from + step / 2);
    const bool grazing = dhr_table_cos(from + step, kFinest) < kGrazing;
    bool straight = true;
    for (std::size_t i = 0; i < spectra; ++i) {
      const double error = std::abs(middle[i] - 0.5 * (a[i] + b[i]));
      straight &= error <= kChordError * (grazing ? std::max(1.0, middle[i]) : 1) ||
                  (grazing && middle[i] > kPole);
    }
    if (straight) return;
    smallest = std::min(smallest, step / 2);
    refine(from, step / 2);
    refine(from + step / 2, step / 2);
  };
  constexpr int kStep = kFinest / kCoarsest;
  for (int from = 0; from < kFinest; from += kStep) refine(from, kStep);

  DhrTable out{kFinest / smallest, spectra, {}};
  for (int cell = 0; cell <= out.cells; ++cell) {
    const int entry = cell * smallest;
    const auto after = known.lower_bound(entry);
    if (after->first == entry) {
      out.value.insert(out.value.end(), after->second.begin(), after->second.end());
      continue;
    }
    const auto before = std::prev(after);
    const double t = static_cast<double>(entry - before->first) / (after->first - before->first);
    for (std::size_t i = 0; i < spectra; ++i)
      out.value.push_back(before->second[i] + t * (after->second[i] - before->second[i]));
  }
  return out;
}

}  // namespace irsig
