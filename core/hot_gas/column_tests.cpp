#include "core/hot_gas/column_tests.h"

#include <algorithm>
#include <cmath>

#include "core/base/ordered_dot.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

constexpr std::array<double, ColumnTests::kDepths> kOpticalDepth = {0.1, 1, 10, 100, 1000, 1e4};
constexpr std::array<double, ColumnTests::kLambdas> kLambdaUm = {4.3, 10};
constexpr std::size_t kOfGas = ColumnTests::kLambdas + 1;

// Solves a x = b, a symmetric and positive, by Cholesky's factors; false: it is not.
bool solve(std::vector<double> a, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      if (i == j) {
        if (!(sum > 1e-13 * a[i * n + i])) return false;
        a[i * n + i] = std::sqrt(sum);
      } else {
        a[i * n + j] = sum / a[j * n + j];
      }
    }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
  return true;
}

}  // namespace

ColumnTests::ColumnTests(const std::array<double, kPlumeSpecies>& most, double hottest_k)
    : hottest_k_(hottest_k) {
  for (std::size_t k = 0; k < kPlumeSpecies; ++k) scale_[k] = most[k] > 0 ? 1 / most[k] : 0;
}

ColumnTests ColumnTests::of(const std::vector<GasColumn>& columns) {
  std::array<double, kPlumeSpecies> most{};
  double hottest_k = 1;
  for (const GasColumn& column : columns) {
    std::array<double, kPlumeSpecies> sum{};
    for (const GasSegment& segment : column) {
      for (std::size_t k = 0; k < kPlumeSpecies; ++k) sum[k] += segment.amount[k];
      hottest_k = std::max(hottest_k, segment.temperature_k);
    }
    for (std::size_t k = 0; k < kPlumeSpecies; ++k) most[k] = std::max(most[k], sum[k]);
  }
  return {most, hottest_k};
}

void ColumnTests::test(const GasColumn& column, std::span<double> out) const {
  static constexpr auto kAll = [] {
    std::array<std::uint32_t, kGases> all{};
    for (std::uint32_t g = 0; g < kGases; ++g) all[g] = g;
    return all;
  }();
  test(column, kAll, out);
}

void ColumnTests::test(const GasColumn& column, std::span<const std::uint32_t> gases,
                       std::span<double> out) const {
  std::array<double, kGases> through;
  through.fill(1);
  std::fill(out.begin(), out.end(), 0.0);
  for (const GasSegment& s : column) {
    std::array<double, kLambdas> b;
    for (std::size_t l = 0; l < kLambdas; ++l)
      b[l] = 0.5 *
             (planck_radiance_w_m2_sr_um(kLambdaUm[l], s.temperature_k - s.temperature_spread_k) +
              planck_radiance_w_m2_sr_um(kLambdaUm[l], s.temperature_k + s.temperature_spread_k));
    const double t = s.temperature_k / hottest_k_, hot = t * t * t * t;
    const std::array<double, kRises> rise = {1.0, hot, hot * hot};
    for (std::size_t g = 0; g < gases.size(); ++g) {
      const std::size_t gas = gases[g], species = gas / (kRises * kDepths);
      const double amount = s.amount[species] * scale_[species];
      if (!(amount > 0)) continue;
      const double taken =
          -through[g] * std::expm1(-kOpticalDepth[depth_of(gas)] * amount * rise[gas % kRises]);
      through[g] -= taken;
      double* of_gas = out.data() + g * kOfGas;
      for (std::size_t l = 0; l < kLambdas; ++l) of_gas[l] += taken * b[l];
      of_gas[kLambdas] += taken;
    }
  }
}

std::array<double, ColumnTests::kGases> ColumnTests::absorbed(std::span<const double> tests) {
  std::array<double, kGases> out{};
  for (std::size_t g = 0; g < kGases; ++g) out[g] = tests[g * kOfGas + kLambdas];
  return out;
}

std::vector<double> column_weights(const std::vector<std::vector<double>>& columns,
                                   std::span<const double> sums, double tolerance,
                                   std::size_t most) {
  // Rows relative to their sums; columns of one size, undone at the end.
  std::vector<std::size_t> used;
  for (std::size_t t = 0; t < sums.size(); ++t)
    if (sums[t] > 0) used.push_back(t);
  const std::size_t rows = used.size(), n = columns.size();
  std::vector<std::vector<double>> a(n, std::vector<double>(rows));
  std::vector<double> size(n);
  for (std::size_t c = 0; c < n; ++c) {
    for (std::size_t r = 0; r < rows; ++r) a[c][r] = columns[c][used[r]] / sums[used[r]];
    size[c] = std::sqrt(ordered_dot(a[c].data(), a[c].data(), rows));
    for (double& x : a[c]) x = size[c] > 0 ? x / size[c] : 0;
  }
  std::vector<double> rest(rows, 1.0), weight(n, 0.0);
  std::vector<std::size_t> passive;
  std::vector<bool> barred(n, false);
  while (passive.size() < most) {
    if (std::all_of(rest.begin(), rest.end(), [&](double x) { return std::abs(x) <= tolerance; }))
      break;
    std::size_t best = n;
    double gradient = 1e-12;
    for (std::size_t c = 0; c < n; ++c) {
      if (weight[c] > 0 || barred[c]) continue;
      if (const double g = ordered_dot(a[c].data(), rest.data(), rows); g > gradient) {
        gradient = g;
        best = c;
      }
    }
    if (best == n) break;
    passive.push_back(best);
    // The best weights of those, with the ones that would be negative taken out one after another.
    for (bool first = true; !passive.empty(); first = false) {
      const std::size_t p = passive.size();
      std::vector<double> normal(p * p), x(p);
      for (std::size_t i = 0; i < p; ++i) {
        for (std::size_t j = 0; j < p; ++j)
          normal[i * p + j] = ordered_dot(a[passive[i]].data(), a[passive[j]].data(), rows);
        for (std::size_t r = 0; r < rows; ++r) x[i] += a[passive[i]][r];
      }
      if (!solve(normal, x) || (first && !(x.back() > 0))) {
        barred[best] = true;  // too like the others
        passive.pop_back();
        break;
      }
      double step = 1;
      for (std::size_t i = 0; i < p; ++i)
        if (x[i] <= 0) step = std::min(step, weight[passive[i]] / (weight[passive[i]] - x[i]));
      for (std::size_t i = 0; i < p; ++i) weight[passive[i]] += step * (x[i] - weight[passive[i]]);
      if (step == 1) {
        std::fill(barred.begin(), barred.end(), false);
        break;
      }
      std::erase_if(passive, [&](std::size_t c) {
        if (weight[c] > 1e-14) return false;
        weight[c] = 0;
        return true;
      });
    }
    for (std::size_t r = 0; r < rows; ++r) {
      rest[r] = 1;
      for (const std::size_t c : passive) rest[r] -= weight[c] * a[c][r];
    }
  }
  for (std::size_t c = 0; c < n; ++c)
    if (size[c] > 0) weight[c] /= size[c];
  return weight;
}

std::vector<double> column_misfit(const std::vector<std::vector<double>>& columns,
                                  std::span<const double> weight, std::span<const double> sums) {
  std::vector<double> out;
  for (std::size_t t = 0; t < sums.size(); ++t) {
    double sum = 0;
    for (std::size_t c = 0; c < columns.size(); ++c) sum += weight[c] * columns[c][t];
    out.push_back(std::abs(sum - sums[t]));
  }
  return out;
}

}  // namespace irsig
