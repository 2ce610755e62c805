#include "core/sources/source_weights.h"

#include "core/base/clones.h"

namespace irsig {

std::uint32_t SourceWeights::new_page() {
  const std::size_t page = value_.size() / (kPage * columns_);
  value_.resize(value_.size() + kPage * columns_, 0.0);
  return static_cast<std::uint32_t>(page);
}

void SourceWeights::clear() {
  std::fill(page_.begin(), page_.end(), kNone);
  value_.clear();
}

void SourceWeights::add(double factor, const SourceWeights& other) {
  for (std::size_t k = 0; k < page_.size(); ++k) {
    if (other.page_[k] == kNone) continue;
    if (page_[k] == kNone) page_[k] = new_page();
    const std::size_t size = kPage * columns_;
    double* to = value_.data() + page_[k] * size;
    const double* from = other.value_.data() + other.page_[k] * size;
    for (std::size_t i = 0; i < size; ++i) to[i] += factor * from[i];
  }
}

SummedWeights summed(const SourceWeights& weights, const SourceLayout& layout, std::size_t parts) {
  const std::size_t columns = weights.columns();
  SummedWeights out{layout.count(), columns, {}};
  out.value.assign(layout.count() * columns, 0.0);
  for (std::uint32_t first = 0; first < parts; ++first)
    weights.for_each(first, layout.all(), [&](SourceId id, const double* row) {
      double* to = out.value.data() + index_of(id) * columns;
      for (std::size_t k = 0; k < columns; ++k) to[k] += row[k];
    });
  return out;
}

namespace {

constexpr std::size_t kLanes = 16;

IRSIG_CLONES void add_products(const double* a, const double* b, std::size_t n, double* part) {
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) part[k] += a[i + k] * b[i + k];
  for (std::size_t k = 0; i < n; ++i, ++k) part[k] += a[i] * b[i];
}

}  // namespace

double SourceWeights::dot(std::uint32_t first, SourceRange range, const double* entry) const {
  double part[kLanes] = {};
  for (std::uint32_t i = range.first; i < range.last;) {
    const std::uint32_t end = std::min(range.last, (i / kPage + 1) * kPage);
    if (const double* row = find(first, SourceId{i}))
      add_products(entry + i * columns_, row, (end - i) * columns_, part);
    i = end;
  }
  double sum = 0;
  for (const double p : part) sum += p;
  return sum;
}

}  // namespace irsig
