#include "core/thermal/periodic_day.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace irsig {
namespace {

constexpr std::size_t kDaysKept = 4;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void subtract(double factor, const std::vector<double>& what, std::vector<double>& from) {
  for (std::size_t i = 0; i < from.size(); ++i) from[i] -= factor * what[i];
}

}  // namespace

PeriodicDay::Next PeriodicDay::next(std::span<const double> begin_k,
                                    std::span<const double> end_k) {
  Day today{{end_k.begin(), end_k.end()}, {end_k.begin(), end_k.end()}};
  for (std::size_t i = 0; i < begin_k.size(); ++i) today.change_k[i] -= begin_k[i];

  // Least squares over differences to today, latest day first (Gram and Schmidt).
  std::vector<double> rest = today.change_k, guess = today.end_k;
  std::vector<Day> basis;
  for (auto day = days_.rbegin(); day != days_.rend(); ++day) {
    Day difference = *day;
    subtract(1, today.change_k, difference.change_k);
    subtract(1, today.end_k, difference.end_k);
    const double whole = dot(difference.change_k, difference.change_k);
    for (const Day& b : basis) {
      const double factor = dot(b.change_k, difference.change_k) / dot(b.change_k, b.change_k);
      subtract(factor, b.change_k, difference.change_k);
      subtract(factor, b.end_k, difference.end_k);
    }
    const double left = dot(difference.change_k, difference.change_k);
    if (!(left > 1e-16 * whole)) continue;
    const double factor = dot(difference.change_k, rest) / left;
    subtract(factor, difference.change_k, rest);
    subtract(factor, difference.end_k, guess);
    basis.push_back(std::move(difference));
  }
  // Far from the solution the day's change is not linear: no guess outside of half to twice today.
  const auto [low, high] = std::ranges::minmax(today.end_k);
  if (!std::ranges::all_of(guess, [&](double t) { return t > 0.5 * low && t < 2 * high; })) {
    guess = today.end_k;
  }
  double left_k = 0;
  for (std::size_t i = 0; i < guess.size(); ++i) {
    left_k = std::max(left_k, std::abs(guess[i] - begin_k[i]));
  }
  // A first day says nothing of how slowly what is left fades.
  if (days_.empty()) left_k = std::numeric_limits<double>::infinity();
  if (days_.size() == kDaysKept) days_.erase(days_.begin());
  days_.push_back(std::move(today));
  return {std::move(guess), left_k};
}

}  // namespace irsig
