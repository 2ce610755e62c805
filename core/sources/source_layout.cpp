#include "core/sources/source_layout.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/environment/land_air.h"
#include "core/environment/sea/sea_glint.h"

namespace irsig {

SourceLayout::SourceLayout(std::size_t parts, const SourceGeometry& geometry)
    : SourceLayout(make(geometry.emitters.count(parts), geometry, false)) {}

SourceLayout SourceLayout::of_light(std::uint32_t emitters, const SourceGeometry& geometry) {
  return make(emitters, geometry, true);
}

SourceLayout SourceLayout::make(std::uint32_t emitters, const SourceGeometry& geometry,
                                bool one_land_sun) {
  SourceLayout out;
  out.emitters_ = emitters;
  out.suns_ = static_cast<std::uint32_t>(geometry.sun.size());
  out.land_suns_ = one_land_sun ? std::min(out.suns_, 1u) : out.suns_;
  out.glint_nodes_ = geometry.glitters() ? static_cast<std::uint32_t>(kGlintCosines.size()) : 0;
  if (const Land* land = std::get_if<Land>(&geometry.boundary)) {
    out.land_materials_ = land->materials();
    out.land_kinds_ = land->kinds();
    out.land_ranges_ = static_cast<std::uint32_t>(kLandRangeM.size());
    out.behind_ranges_ = geometry.behind ? land->behind_ranges() : 0;
  }
  out.sky_ = 2 * emitters;
  out.lower_ = out.sky_ + geometry.directions.sky();
  out.land_ = out.lower_ + geometry.directions.lower();
  const std::uint32_t lands = out.land_materials_ * out.land_ranges_,
                      behind_lands = out.land_materials_ * out.behind_ranges_;
  out.sun_ = out.land_ + (out.land_kinds_ + out.land_materials_) * out.land_ranges_;
  out.glint_ = out.sun_ + out.suns_;
  out.land_sun_ = out.glint_ + out.suns_ * out.glint_nodes_;
  out.behind_ = out.land_sun_ + out.land_suns_ * lands;
  out.behind_land_ = out.behind_ + (geometry.behind ? geometry.behind->count() : 0);
  out.behind_land_sun_ =
      out.behind_land_ + (out.land_kinds_ + out.land_materials_) * out.behind_ranges_;
  out.end_ = out.behind_land_sun_ + out.land_suns_ * behind_lands;
  return out;
}

SourceLayout::Place SourceLayout::place_of(SourceId id) const {
  const std::uint32_t i = index_of(id);
  IRSIG_CHECK(i < count());
  if (i < emitters_) return {Kind::kSeen, i};
  if (i < sky_) return {Kind::kReflected, i - emitters_};
  if (i < lower_) return {Kind::kSky, i - sky_};
  if (i < land_) return {Kind::kLower, i - sky_};
  if (i < sun_) return {Kind::kLand, i - land_};
  if (i < glint_) return {Kind::kSun, i - sun_};
  if (i < land_sun_)
    return {Kind::kGlint, (i - glint_) / glint_nodes_, (i - glint_) % glint_nodes_};
  const auto of_sun = [&](Kind kind, std::uint32_t k, std::uint32_t ranges) {
    const std::uint32_t lands = land_materials_ * ranges;
    return Place{kind, k / lands, k % lands};
  };
  if (i < behind_) return of_sun(Kind::kLandSun, i - land_sun_, land_ranges_);
  if (i < behind_land_) return {Kind::kBehind, i - behind_};
  if (i < behind_land_sun_) return {Kind::kBehindLand, i - behind_land_};
  return of_sun(Kind::kBehindLandSun, i - behind_land_sun_, behind_ranges_);
}

std::array<std::vector<SourceRange>, kCauses> SourceLayout::causes(
    std::span<const std::uint32_t> suns) const {
  static_assert(static_cast<int>(Cause::kPartsReflected) == 4 && kCauses == 5);
  const auto from = [](SourceId first, std::uint32_t size) {
    return SourceRange{index_of(first), index_of(first) + size};
  };
  std::array<std::vector<SourceRange>, kCauses> out{
      {{emitted()}, {}, {sky()}, {lower()}, {from(reflected(0), emitters_)}}};
  std::vector<SourceRange>& of_surface = out[static_cast<std::size_t>(Cause::kSeaReflected)];
  const std::uint32_t lands = land_materials_ * land_ranges_;
  if (lands > 0) of_surface.push_back(land());
  for (const std::uint32_t j : suns) {
    out[static_cast<std::size_t>(Cause::kSunReflected)].push_back(from(sun(j), 1));
    of_surface.push_back(from(glint(j, 0), glint_nodes_));
    if (lands > 0) of_surface.push_back(from(land_sun(j, 0, 0), lands));
  }
  return out;
}

}  // namespace irsig
