#include "core/base/csv_rows.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace irsig {

bool CsvRows::next() {
  while (next_with_remarks())
    if (whole_.front() != '#') return true;
  return false;
}

bool CsvRows::next_with_remarks() {
  while (!text_.empty()) {
    const std::size_t end = std::min(text_.find_first_of("\r\n"), text_.size());
    whole_ = text_.substr(0, end);
    text_.remove_prefix(std::min(end + (text_.substr(end, 2) == "\r\n" ? 2 : 1), text_.size()));
    ++line_;
    if (whole_.find_first_not_of(" \t") != std::string_view::npos) return true;
  }
  whole_ = {};
  return false;
}

const std::vector<CsvCell>& CsvRows::cells() {
  cell_.clear();
  for (std::size_t at = 0;;) {
    std::size_t first = at;
    while (first < whole_.size() && (whole_[first] == ' ' || whole_[first] == '\t')) ++first;
    std::size_t end = std::min(whole_.find(',', at), whole_.size());
    std::size_t last = end;
    first = std::min(first, end);
    // Quotes around a cell and nothing else: others are characters as any.
    if (first < end && whole_[first] == '"') {
      const std::size_t closing = whole_.find('"', first + 1);
      const std::size_t behind = std::min(
          whole_.find_first_not_of(" \t", std::min(closing, whole_.size() - 1) + 1), whole_.size());
      if (closing != whole_.npos && (behind == whole_.size() || whole_[behind] == ',')) {
        ++first;
        last = closing;
        end = behind;
      }
    }
    while (last > first && (whole_[last - 1] == ' ' || whole_[last - 1] == '\t')) --last;
    cell_.push_back({whole_.substr(first, last - first), line_, first + 1});
    if (end == whole_.size()) return cell_;
    at = end + 1;
  }
}

std::optional<double> finite_number(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

}  // namespace irsig
