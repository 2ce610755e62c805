#include "core/materials/wavelength_range.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace irsig {
namespace {

// Narrows a range by a model's tables over wavelength; a table of one point holds everywhere.
struct Narrow {
  WavelengthRange& range;

  void operator()(MaterialKey /*key*/, const Spectrum& table) const { narrow_by(table); }
  void operator()(MaterialKey /*key*/, const OpticalConstants& table) const { narrow_by(table); }
  void operator()(MaterialKey /*key*/, const TabulatedBrdf& m) const {
    if (!m.lambda_um.empty()) narrow(m.lambda_um.front(), m.lambda_um.back(), m.lambda_um.size());
  }
  template <typename Other>
  void operator()(MaterialKey /*key*/, const Other& /*no table*/) const {}

 private:
  template <typename Table>
  void narrow_by(const Table& table) const {
    if (!table.empty()) narrow(table.front().lambda_um, table.back().lambda_um, table.size());
  }
  void narrow(double first_um, double last_um, std::size_t points) const {
    if (points < 2) return;
    range.everywhere = false;
    range.min_um = std::max(range.min_um, first_um);
    range.max_um = std::min(range.max_um, last_um);
  }
};

}  // namespace

WavelengthRange wavelength_range(const MaterialSpec& spec) {
  WavelengthRange range{0, std::numeric_limits<double>::infinity(), true};
  for_each_property(spec.model, Narrow{range});
  return range;
}

}  // namespace irsig
