#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/accuracy/replicates.h"
#include "core/sources/source_layout.h"

namespace irsig {

// RowNumbers holds the numbers of one row under their names: T is double for one replicate, and
// Estimate for the statistics over all replicates. Intensities in W/sr, the background in
// W/(m2 sr); spectra per um on the band's stored wavelengths. Pilots have no spectra, and 0 for
// each part.
template <typename T>
struct RowNumbers {
  T total{};
  std::array<T, kCauses> cause{};
  T apparent{};
  T projected_area_m2{};
  std::vector<T> part;  // by the part that the sensor sees
  T contrast{};
  T background{};
  std::vector<T> total_spectrum;
  std::array<std::vector<T>, kCauses> cause_spectrum;
  std::vector<T> apparent_spectrum, contrast_spectrum, background_spectrum;

  // Sets all numbers to 0, for so many parts and stored wavelengths.
  void reset(std::size_t parts, std::size_t bins) {
    total = apparent = projected_area_m2 = contrast = background = T{};
    cause.fill(T{});
    part.assign(parts, T{});
    for (std::vector<T>* spectrum :
         {&total_spectrum, &apparent_spectrum, &contrast_spectrum, &background_spectrum})
      spectrum->assign(bins, T{});
    for (std::vector<T>& spectrum : cause_spectrum) spectrum.assign(bins, T{});
  }

  // Visits every number once, in a fixed order.
  template <typename Visit>
  void for_each(Visit&& visit) {
    visit_all(*this, visit);
  }
  template <typename Visit>
  void for_each(Visit&& visit) const {
    visit_all(*this, visit);
  }

 private:
  template <typename Numbers, typename Visit>
  static void visit_all(Numbers& of, Visit& visit) {
    visit(of.total);
    for (auto& x : of.cause) visit(x);
    visit(of.apparent);
    visit(of.projected_area_m2);
    for (auto& x : of.part) visit(x);
    visit(of.contrast);
    visit(of.background);
    for (auto& x : of.total_spectrum) visit(x);
    for (auto& spectrum : of.cause_spectrum)
      for (auto& x : spectrum) visit(x);
    for (auto& x : of.apparent_spectrum) visit(x);
    for (auto& x : of.contrast_spectrum) visit(x);
    for (auto& x : of.background_spectrum) visit(x);
  }
};
using RowTally = RowNumbers<double>;
using RowEstimate = RowNumbers<Estimate>;

// Returns mean and standard error over replicates of every number of a row.
//   tally  [replicate], at least one; all of the same size
[[nodiscard]] RowEstimate estimates_of(std::span<const RowTally> tally);

}  // namespace irsig
