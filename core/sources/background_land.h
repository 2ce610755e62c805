#pragma once

#include <cstdint>
#include <span>

#include "core/sources/source_layout.h"

namespace irsig {

// Calls visit(source, weight) for the sources of SourceLayout::behind_lands of which land at a
// point consists as a sensor sees it.
//   range_m   from the sensor
//   mix       of that point
//   shaded    (sun): whether anything but land shades that point
template <typename Shaded, typename Visit>
void for_each_behind(const Land& land, const SourceLayout& layout,
                     std::span<const SunDirection> suns, const LandPoint& at, double range_m,
                     const LandMix& mix, const Shaded& shaded, Visit&& visit) {
  const Land::RangeShare range = land.behind(range_m);
  const float open = Land::sky_fraction(at);
  const auto each = [&](float share, const auto& source) {
    for (std::uint32_t k = 0; k < 2; ++k)
      if (const float w = share * range.weight(k); w > 0) visit(source(range.node + k), w);
  };
  for (const KindShare& part : mix.kind)
    each(open * part.share,
         [&](std::uint32_t node) { return layout.behind_land(part.kind, node); });
  for (std::uint32_t m = 0; m < mix.fraction.size(); ++m)
    each((1 - open) * mix.fraction[m],
         [&](std::uint32_t node) { return layout.behind_land(layout.land_kinds() + m, node); });
  for (std::uint32_t j = 0; j < suns.size(); ++j)
    if (const double cosine = land.sun_cosine(at, suns[j].direction); cosine > 0 && !shaded(j))
      for (std::uint32_t m = 0; m < mix.fraction.size(); ++m)
        each(static_cast<float>(cosine) * mix.fraction[m],
             [&](std::uint32_t node) { return layout.behind_land_sun(j, m, node); });
}

}  // namespace irsig
