#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/sources/source_layout.h"

namespace irsig {

// Weights of paths by source: [first part seen][source], a row of `columns` numbers for each (one
// if all materials are grey, one for each carried wavelength else). Only pairs of a part and a
// source that paths have met are kept, in pages of kPage sources: with 10^4 emitters a table of all
// pairs would not fit.
//
// Memory: 4 bytes for each part and page of sources, and for each page that was met kPage x columns
// x 8 bytes, at most twice that while it grows. It depends on the pairs that paths join, never on
// the number of paths (tests/unit/sources_test.cpp).
class SourceWeights {
 public:
  static constexpr std::uint32_t kPage = 16;

  SourceWeights() = default;
  SourceWeights(std::uint32_t firsts, const SourceLayout& layout, std::size_t columns)
      : pages_((layout.count() + kPage - 1) / kPage),
        columns_(columns),
        page_(static_cast<std::size_t>(firsts) * pages_, kNone) {}

  [[nodiscard]] bool empty() const { return page_.empty(); }
  [[nodiscard]] std::uint32_t firsts() const {
    return pages_ == 0 ? 0 : static_cast<std::uint32_t>(page_.size() / pages_);
  }
  [[nodiscard]] std::size_t columns() const { return columns_; }

  // Returns the row to add to. Valid until the next call.
  [[nodiscard]] double* row(std::uint32_t first, SourceId id) {
    const std::uint32_t i = index_of(id);
    std::uint32_t& page = page_[static_cast<std::size_t>(first) * pages_ + i / kPage];
    if (page == kNone) page = new_page();
    return value_.data() + (static_cast<std::size_t>(page) * kPage + i % kPage) * columns_;
  }

  // Null: all 0, since no path has met this page.
  [[nodiscard]] const double* find(std::uint32_t first, SourceId id) const {
    const std::uint32_t i = index_of(id);
    const std::uint32_t page = page_[static_cast<std::size_t>(first) * pages_ + i / kPage];
    return page == kNone
               ? nullptr
               : value_.data() + (static_cast<std::size_t>(page) * kPage + i % kPage) * columns_;
  }
  [[nodiscard]] double value(std::uint32_t first, SourceId id, std::size_t column = 0) const {
    const double* row = find(first, id);
    return row == nullptr ? 0 : row[column];
  }

  // Calls visit(source, row) in increasing order of the sources of a range, without those of pages
  // that no path has met.
  template <typename Visit>
  void for_each(std::uint32_t first, SourceRange range, Visit&& visit) const {
    for (std::uint32_t i = range.first; i < range.last;) {
      const std::uint32_t end = std::min(range.last, (i / kPage + 1) * kPage);
      if (const double* row = find(first, SourceId{i}))
        for (std::uint32_t k = i; k < end; ++k, row += columns_) visit(SourceId{k}, row);
      i = end;
    }
  }

  // Returns the sum over sources of a range, and over columns, of entry[source][column] x weight.
  // Its order depends on the range and the columns alone.
  [[nodiscard]] double dot(std::uint32_t first, SourceRange range, const double* entry) const;

  // Sets all numbers to 0 and keeps the memory.
  void clear();
  // Adds factor x the other's, a table of the same shape.
  void add(double factor, const SourceWeights& other);

  [[nodiscard]] std::size_t bytes() const {
    return page_.capacity() * sizeof(std::uint32_t) + value_.capacity() * sizeof(double);
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  [[nodiscard]] std::uint32_t new_page();

  std::uint32_t pages_ = 0;  // of one first part
  std::size_t columns_ = 1;
  std::vector<std::uint32_t> page_;  // [first][page of sources]: where it is; kNone: nowhere
  std::vector<double> value_;        // [page][source in it][column]
};

// The weights of one replicate, summed over the parts seen first. [source][column]
struct SummedWeights {
  std::uint32_t sources = 0;
  std::size_t columns = 0;
  std::vector<double> value;

  [[nodiscard]] const double* row(SourceId id) const {
    return value.data() + index_of(id) * columns;
  }
};
// Sums weights over parts 0 .. parts - 1.
[[nodiscard]] SummedWeights summed(const SourceWeights& weights, const SourceLayout& layout,
                                   std::size_t parts);

}  // namespace irsig
