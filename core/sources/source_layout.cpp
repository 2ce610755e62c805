#include "core/sources/source_layout.h"

#include "core/base/check.h"
#include "core/environment/sea_glint.h"

namespace irsig {

SourceLayout::SourceLayout(std::size_t parts, const SourceGeometry& geometry)
    : SourceLayout(with_emitters(geometry.emitters.count(parts), geometry)) {}

SourceLayout SourceLayout::with_emitters(std::uint32_t emitters, const SourceGeometry& geometry) {
  SourceLayout out;
  out.emitters_ = emitters;
  out.suns_ = static_cast<std::uint32_t>(geometry.sun.size());
  out.glint_nodes_ = geometry.glitters() ? static_cast<std::uint32_t>(kGlintCosines.size()) : 0;
  out.background_directions_ = geometry.behind ? geometry.behind->count() : 0;
  out.sky_ = 2 * emitters;
  out.lower_ = out.sky_ + geometry.directions.sky();
  out.sun_ = out.lower_ + geometry.directions.lower();
  out.glint_ = out.sun_ + out.suns_;
  out.behind_ = out.glint_ + out.suns_ * out.glint_nodes_;
  return out;
}

SourceLayout::Place SourceLayout::place_of(SourceId id) const {
  const std::uint32_t i = index_of(id);
  IRSIG_CHECK(i < count());
  if (i < emitters_) return {Kind::kSeen, i};
  if (i < sky_) return {Kind::kReflected, i - emitters_};
  if (i < lower_) return {Kind::kSky, i - sky_};
  if (i < sun_) return {Kind::kLower, i - sky_};
  if (i < glint_) return {Kind::kSun, i - sun_};
  if (i >= behind_) return {Kind::kBehind, i - behind_};
  return {Kind::kGlint, (i - glint_) / glint_nodes_, (i - glint_) % glint_nodes_};
}

std::array<std::vector<SourceRange>, kCauses> SourceLayout::causes(
    std::span<const std::uint32_t> suns) const {
  static_assert(static_cast<int>(Cause::kPartsReflected) == 4 && kCauses == 5);
  const auto from = [](SourceId first, std::uint32_t size) {
    return SourceRange{index_of(first), index_of(first) + size};
  };
  std::array<std::vector<SourceRange>, kCauses> out{
      {{emitted()}, {}, {sky()}, {lower()}, {from(reflected(0), emitters_)}}};
  for (const std::uint32_t j : suns) {
    out[static_cast<std::size_t>(Cause::kSunReflected)].push_back(from(sun(j), 1));
    out[static_cast<std::size_t>(Cause::kSeaReflected)].push_back(from(glint(j, 0), glint_nodes_));
  }
  return out;
}

}  // namespace irsig
