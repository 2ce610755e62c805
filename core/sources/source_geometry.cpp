#include "core/sources/source_geometry.h"

#include <algorithm>
#include <type_traits>

namespace irsig {

std::optional<Plane> plane_of(const Boundary& boundary) {
  return std::visit(
      [](const auto& b) -> std::optional<Plane> {
        if constexpr (std::is_base_of_v<Plane, std::decay_t<decltype(b)>>)
          return Plane{b};
        else
          return std::nullopt;
      },
      boundary);
}

bool SourceGeometry::glitters() const {
  return std::holds_alternative<Sea>(boundary) &&
         std::any_of(sun.begin(), sun.end(),
                     [](const SunDirection& s) { return s.sea_wind_m_s > 0 && s.direction.z < 0; });
}

}  // namespace irsig
