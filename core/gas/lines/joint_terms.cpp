#include "core/gas/lines/joint_terms.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace irsig {
namespace {

std::vector<std::uint32_t> sorted(const double* cold, std::size_t first, std::size_t count) {
  std::vector<std::uint32_t> point(count);
  for (std::size_t i = 0; i < count; ++i) point[i] = static_cast<std::uint32_t>(first + i);
  std::ranges::sort(point, [&](std::uint32_t a, std::uint32_t b) {
    return cold[a - first] != cold[b - first] ? cold[a - first] < cold[b - first] : a < b;
  });
  return point;
}

void add_term(ColdTerms& out, std::vector<std::uint32_t> point, std::size_t count) {
  if (point.empty()) return;
  out.weight.push_back(static_cast<double>(point.size()) / static_cast<double>(count));
  out.point.push_back(std::move(point));
}

// Ends of shares of n points, each of at least one while there are points left.
std::vector<std::size_t> ends(const std::vector<double>& share, std::size_t n) {
  std::vector<std::size_t> out;
  double sum = 0;
  for (const double s : share) {
    sum += s;
    out.push_back(std::min(n, static_cast<std::size_t>(std::lround(sum * static_cast<double>(n)))));
  }
  out.back() = n;
  return out;
}

// Points in an order, cut into terms of given shares.
void add_shares(ColdTerms& out, const std::vector<std::uint32_t>& point,
                const std::vector<double>& share, std::size_t count) {
  std::size_t begin = 0;
  for (const std::size_t end : ends(share, point.size())) {
    add_term(out,
             {point.begin() + static_cast<std::ptrdiff_t>(begin),
              point.begin() + static_cast<std::ptrdiff_t>(end)},
             count);
    begin = end;
  }
}

}  // namespace

ColdTerms terms_by_ratio(const double* cold, std::size_t first, std::size_t count, int terms) {
  const std::vector<std::uint32_t> point = sorted(cold, first, count);
  const double low = std::log(cold[point.front() - first]),
               high = std::log(cold[point.back() - first]);
  ColdTerms out;
  std::vector<std::uint32_t> some;
  int term = 1;
  for (const std::uint32_t p : point) {
    while (term < terms && std::log(cold[p - first]) > low + (high - low) * term / terms) {
      add_term(out, std::move(some), count);
      some.clear();
      ++term;
    }
    some.push_back(p);
  }
  add_term(out, std::move(some), count);
  return out;
}

ColdTerms terms_by_share(const double* cold, std::size_t first, std::size_t count,
                         const std::vector<double>& share) {
  ColdTerms out;
  add_shares(out, sorted(cold, first, count), share, count);
  return out;
}

ColdTerms nested_terms(const double* cold, const std::vector<double>& hot, std::size_t first,
                       std::size_t count, const std::vector<double>& share,
                       const std::vector<double>& within) {
  ColdTerms out;
  for (std::vector<std::uint32_t>& point : terms_by_share(cold, first, count, share).point) {
    std::ranges::sort(point, [&](std::uint32_t a, std::uint32_t b) {
      return hot[a] != hot[b] ? hot[a] < hot[b] : a < b;
    });
    add_shares(out, point, within, count);
  }
  return out;
}

std::vector<double> hot_bins(const std::vector<double>& hot, const ColdTerms& terms,
                             const std::vector<double>& share) {
  std::vector<double> out;
  for (const std::vector<std::uint32_t>& point : terms.point) {
    std::vector<double> k;
    for (const std::uint32_t p : point) k.push_back(hot[p]);
    std::ranges::sort(k);
    // A term may have fewer points than there are bins: its few points then stand for more.
    std::size_t begin = 0;
    for (const std::size_t end : ends(share, k.size())) {
      const std::size_t last = std::max(end, begin + 1), from = std::min(begin, k.size() - 1);
      double sum = 0;
      for (std::size_t i = from; i < std::min(last, k.size()); ++i) sum += k[i];
      out.push_back(sum / static_cast<double>(std::min(last, k.size()) - from));
      begin = end;
    }
  }
  return out;
}

double effective(const std::vector<double>& cold, const std::vector<std::uint32_t>& point,
                 double reference) {
  double sum = 0;
  for (const std::uint32_t p : point) sum += std::exp(-cold[p] / reference);
  return -std::log(sum / static_cast<double>(point.size())) * reference;
}

}  // namespace irsig
