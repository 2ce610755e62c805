#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace irsig {

// Directional-hemispherical reflectance over angle: linear in sqrt(cos theta) between `cells` + 1
// equally spaced entries; entry 0 stands for cos theta = 1e-8 (90 deg - 6e-7 deg).
struct DhrTable {
  int cells;
  std::size_t spectra;
  std::vector<double> value;  // [cells + 1][spectra]
};

// Tabulates dhr(cos_o, out[spectra]). Cells are halved, from 256 up to 16384 in all, until the
// middle of each lies within 1e-5 of the chord. Beyond 89.05 deg that is relative where DHR > 1,
// and where DHR > 10, at the grazing poles of models that create energy, cells stay as they are.
[[nodiscard]] DhrTable tabulate_dhr(std::size_t spectra,
                                    const std::function<void(double, std::span<double>)>& dhr);

// Returns cos theta of an entry.
[[nodiscard]] double dhr_table_cos(int entry, int cells);

}  // namespace irsig
