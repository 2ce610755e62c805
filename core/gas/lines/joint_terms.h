#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace irsig {

// Groups of a band's wavenumbers: terms by the cold air's absorption, and within each term bins by
// the hot gas's, so that bright wavenumbers stay together with the air's absorption there.
struct ColdTerms {
  std::vector<std::vector<std::uint32_t>> point;  // [term]: of the grid, sorted by cold absorption
  std::vector<double> weight;                     // [term], sum 1
};

// Terms of equal steps in ln k, each of at least one point.
//   cold  absorption at the band's points, which begin at `first` of the grid
[[nodiscard]] ColdTerms terms_by_ratio(const double* cold, std::size_t first, std::size_t count,
                                       int terms);
// Terms of given shares of the points, from the weakest on.
[[nodiscard]] ColdTerms terms_by_share(const double* cold, std::size_t first, std::size_t count,
                                       const std::vector<double>& share);

// Terms of given shares, each cut into terms of given shares by what hotter gas absorbs.
//   hot  absorption on the whole grid
[[nodiscard]] ColdTerms nested_terms(const double* cold, const std::vector<double>& hot,
                                     std::size_t first, std::size_t count,
                                     const std::vector<double>& share,
                                     const std::vector<double>& within);

// Computes the mean absorption of the hot gas in each bin of each term, [term * shares + bin]. Bins
// are ordered by the hot absorption itself and hold given shares of the term's points.
[[nodiscard]] std::vector<double> hot_bins(const std::vector<double>& hot, const ColdTerms& terms,
                                           const std::vector<double>& share);

// Returns the absorption that a term's mean transmittance shows where its depth at `reference` is
// 1.
[[nodiscard]] double effective(const std::vector<double>& cold,
                               const std::vector<std::uint32_t>& point, double reference);

}  // namespace irsig
