#include "core/materials/wavelength_range.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace irsig {
namespace {

// Narrows a range by tables over wavelength; a table of one point is the same everywhere.
class Range {
 public:
  template <typename... Tables>
  void add(const Tables&... tables) {
    (add_table(tables), ...);
  }
  [[nodiscard]] WavelengthRange range() const { return {min_um_, max_um_, everywhere_}; }

  void add_points(double first_um, double last_um, std::size_t points) {
    if (points < 2) return;
    everywhere_ = false;
    min_um_ = std::max(min_um_, first_um);
    max_um_ = std::min(max_um_, last_um);
  }

 private:
  template <typename Table>
  void add_table(const Table& table) {
    if (!table.empty()) add_points(table.front().lambda_um, table.back().lambda_um, table.size());
  }
  double min_um_ = 0, max_um_ = std::numeric_limits<double>::infinity();
  bool everywhere_ = true;
};

struct Narrow {
  Range& range;
  void operator()(const Lambert& m) const { range.add(m.emissivity); }
  void operator()(const CookTorrance& m) const { range.add(m.constants); }
  void operator()(const Ward& m) const { range.add(m.diffuse, m.specular); }
  void operator()(const SandfordRobertson& m) const { range.add(m.emissivity, m.diffuse); }
  void operator()(const PriestGermer& m) const { range.add(m.constants); }
  void operator()(const BeardMaxwell& m) const { range.add(m.constants, m.diffuse, m.volume); }
  void operator()(const Prisse& m) const { range.add(m.reflectance); }
  void operator()(const TabulatedBrdf& m) const {
    if (!m.lambda_um.empty())
      range.add_points(m.lambda_um.front(), m.lambda_um.back(), m.lambda_um.size());
  }
};

}  // namespace

WavelengthRange wavelength_range(const MaterialSpec& spec) {
  Range range;
  std::visit(Narrow{range}, spec.model);
  return range.range();
}

}  // namespace irsig
