#pragma once

#include <cstdint>
#include <span>

#include "core/sources/source_layout.h"

namespace irsig {

// visit(source, weight): the sources of SourceLayout::behind_lands of which land at a point
// consists as a sensor sees it.
//   range_m   from the sensor
//   fraction  [material] at that point
//   shaded    (sun): whether anything but land shades that point
template <typename Shaded, typename Visit>
void for_each_behind(const Land& land, const SourceLayout& layout,
                     std::span<const SunDirection> suns, const LandPoint& at, double range_m,
                     std::span<const float> fraction, const Shaded& shaded, Visit&& visit) {
  const Land::RangeShare range = land.behind(range_m);
  const float open = Land::sky_fraction(at);
  const auto each = [&](float factor, const auto& source) {
    for (std::uint32_t m = 0; m < fraction.size(); ++m)
      for (std::uint32_t k = 0; k < 2; ++k)
        if (const float w = factor * fraction[m] * range.weight(k); w > 0)
          visit(source(m, range.node + k), w);
  };
  each(open, [&](std::uint32_t m, std::uint32_t node) { return layout.behind_land(m, node); });
  each(1 - open, [&](std::uint32_t m, std::uint32_t node) {
    return layout.behind_land(layout.land_materials() + m, node);
  });
  for (std::uint32_t j = 0; j < suns.size(); ++j)
    if (const double cosine = land.sun_cosine(at, suns[j].direction); cosine > 0 && !shaded(j))
      each(static_cast<float>(cosine),
           [&](std::uint32_t m, std::uint32_t node) { return layout.behind_land_sun(j, m, node); });
}

}  // namespace irsig
