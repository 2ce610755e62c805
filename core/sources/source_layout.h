#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/sources/source_geometry.h"

namespace irsig {

// One source of light as paths end on it: a number from 0 to SourceLayout::count() - 1. What stands
// behind the number only SourceLayout knows; elsewhere it indexes tables.
enum class SourceId : std::uint32_t {};
[[nodiscard]] constexpr std::uint32_t index_of(SourceId id) {
  return static_cast<std::uint32_t>(id);
}

// Sources that stand side by side.
struct SourceRange {
  std::uint32_t first = 0, last = 0;  // behind the last

  struct Iterator {
    std::uint32_t at;
    SourceId operator*() const { return SourceId{at}; }
    Iterator& operator++() {
      ++at;
      return *this;
    }
    bool operator==(const Iterator&) const = default;
  };
  [[nodiscard]] Iterator begin() const { return {first}; }
  [[nodiscard]] Iterator end() const { return {last}; }
  [[nodiscard]] std::uint32_t size() const { return last - first; }
  [[nodiscard]] bool contains(SourceId id) const {
    return index_of(id) >= first && index_of(id) < last;
  }
};

// Causes into which a signature is divided.
enum class Cause { kEmitted, kSunReflected, kSkyReflected, kSeaReflected, kPartsReflected };
inline constexpr std::size_t kCauses = 5;

// The places of all sources in a table of them, side by side:
//
//   seen(e)       emitted by emitter e, straight towards the sensor
//   reflected(e)  emitted by emitter e, reflected towards the sensor
//   node(k)       from around the target, at direction node k: above the horizon, then below it
//   sun(j)        direct sun j, per unit irradiance normal to the beam
//   glint(j, k)   sun j mirrored by the sea, at an incidence of kGlintCosines[k], per unit
//                 irradiance normal to the beam and unit reflectance
//   land(k, r)    land of kind k at node r of its range: emission and the sky that it reflects.
//                 k from land_kinds() on: of a material, facing land instead of the sky
//   land_sun(j, m, r)  sun j reflected by land of material m, per unit cosine of its incidence
//   behind(k)     not part of the intensity: what of the silhouette stands before direction node k
//                 (seen from the sensor, beyond the target), for the contrast
//   behind_land(k, r), behind_land_sun(j, m, r)  likewise, before land
class SourceLayout {
 public:
  SourceLayout() = default;
  SourceLayout(std::size_t parts, const SourceGeometry& geometry);
  // Returns the layout with another number of emitters than paths can end on, and sunlit land of
  // one sun alone: a condition has no other, and tables of all suns for each condition would grow
  // with the square of the conditions.
  [[nodiscard]] static SourceLayout of_light(std::uint32_t emitters,
                                             const SourceGeometry& geometry);

  enum class Kind : std::uint8_t {
    kSeen,
    kReflected,
    kSky,
    kLower,
    kLand,
    kSun,
    kGlint,
    kLandSun,
    kBehind,
    kBehindLand,
    kBehindLandSun
  };
  struct Place {
    Kind kind;
    // Index of the emitter, the node (below the horizon: as above it), the sun; of land: kind x
    // ranges + node of the range.
    std::uint32_t index;
    // Node of kGlintCosines; for the land of a sun: material x ranges + node of the range.
    std::uint32_t second = 0;
  };
  [[nodiscard]] Place place_of(SourceId id) const;

  [[nodiscard]] std::uint32_t emitters() const { return emitters_; }
  [[nodiscard]] std::uint32_t suns() const { return suns_; }
  [[nodiscard]] std::uint32_t count() const { return end_; }

  [[nodiscard]] SourceId seen(std::uint32_t emitter) const { return SourceId{emitter}; }
  [[nodiscard]] SourceId reflected(std::uint32_t emitter) const {
    return SourceId{emitters_ + emitter};
  }
  [[nodiscard]] SourceId node(std::uint32_t k) const { return SourceId{sky_ + k}; }
  [[nodiscard]] SourceId first_sky() const { return SourceId{sky_}; }
  [[nodiscard]] SourceId first_lower() const { return SourceId{lower_}; }
  [[nodiscard]] SourceId sun(std::uint32_t j) const { return SourceId{sun_ + j}; }
  [[nodiscard]] SourceId glint(std::uint32_t j, std::uint32_t k) const {
    return SourceId{glint_ + j * glint_nodes_ + k};
  }
  [[nodiscard]] SourceId land(std::uint32_t kind, std::uint32_t range) const {
    return SourceId{land_ + kind * land_ranges_ + range};
  }
  [[nodiscard]] SourceId land_sun(std::uint32_t j, std::uint32_t material,
                                  std::uint32_t range) const {
    return SourceId{land_sun_ + (land_slot(j) * land_materials_ + material) * land_ranges_ + range};
  }
  [[nodiscard]] SourceId behind(std::uint32_t k) const { return SourceId{behind_ + k}; }
  [[nodiscard]] SourceId behind_land(std::uint32_t kind, std::uint32_t range) const {
    return SourceId{behind_land_ + kind * behind_ranges_ + range};
  }
  [[nodiscard]] SourceId behind_land_sun(std::uint32_t j, std::uint32_t material,
                                         std::uint32_t range) const {
    return SourceId{behind_land_sun_ +
                    (land_slot(j) * land_materials_ + material) * behind_ranges_ + range};
  }
  [[nodiscard]] std::uint32_t land_kinds() const { return land_kinds_; }
  [[nodiscard]] std::uint32_t land_ranges() const { return land_ranges_; }
  [[nodiscard]] std::uint32_t behind_ranges() const { return behind_ranges_; }

  [[nodiscard]] SourceRange all() const { return {0, count()}; }
  // Returns all sources but those behind the target.
  [[nodiscard]] SourceRange of_intensity() const { return {0, behind_}; }
  [[nodiscard]] SourceRange emitted() const { return {0, emitters_}; }
  [[nodiscard]] SourceRange all_emitted() const { return {0, sky_}; }  // reflected or not
  [[nodiscard]] SourceRange sky() const { return {sky_, lower_}; }
  [[nodiscard]] SourceRange lower() const { return {lower_, land_}; }
  [[nodiscard]] SourceRange around() const { return {sky_, land_}; }
  [[nodiscard]] SourceRange land() const { return {land_, sun_}; }
  [[nodiscard]] SourceRange land_suns() const { return {land_sun_, behind_}; }
  // Returns the sources of land lit by sun j: around the target, and behind it.
  [[nodiscard]] SourceRange land_suns(std::uint32_t j) const {
    const std::uint32_t first = index_of(land_sun(j, 0, 0));
    return {first, first + land_materials_ * land_ranges_};
  }
  [[nodiscard]] SourceRange behind_land_suns(std::uint32_t j) const {
    const std::uint32_t first = index_of(behind_land_sun(j, 0, 0));
    return {first, first + land_materials_ * behind_ranges_};
  }
  [[nodiscard]] SourceRange behind_without_sun() const { return {behind_, behind_land_sun_}; }
  // Sources that shine with and without the sun: the emission of target and surroundings.
  [[nodiscard]] SourceRange without_sun() const { return {0, sun_}; }
  [[nodiscard]] SourceRange behind() const { return {behind_, count()}; }
  [[nodiscard]] SourceRange behind_directions() const { return {behind_, behind_land_}; }
  [[nodiscard]] SourceRange behind_lands() const { return {behind_land_, count()}; }

  // Returns the sources of each cause under the given suns. The sea's are in several pieces: its
  // emission and its reflection of the sky, and the suns in it. Suns of other conditions are left
  // out: no sum may depend on the conditions that are computed beside it.
  [[nodiscard]] std::array<std::vector<SourceRange>, kCauses> causes(
      std::span<const std::uint32_t> suns) const;

 private:
  [[nodiscard]] static SourceLayout make(std::uint32_t emitters, const SourceGeometry& geometry,
                                         bool one_land_sun);
  // Returns which of the suns that have sources on land this is.
  [[nodiscard]] std::uint32_t land_slot(std::uint32_t j) const {
    return land_suns_ == suns_ ? j : 0;
  }

  std::uint32_t emitters_ = 0, suns_ = 0, land_suns_ = 0, glint_nodes_ = 0, land_kinds_ = 0,
                land_materials_ = 0, land_ranges_ = 0, behind_ranges_ = 0;
  // Index at which each kind begins.
  std::uint32_t sky_ = 0, lower_ = 0, land_ = 0, sun_ = 0, glint_ = 0, land_sun_ = 0, behind_ = 0,
                behind_land_ = 0, behind_land_sun_ = 0, end_ = 0;
};

}  // namespace irsig
