#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geo/frames.h"

namespace irsig {

inline constexpr std::uint32_t kHorizonAzimuths = 32;
// Most horizons of a land.
inline constexpr std::uint32_t kMostLandHorizons = 8;

// Elevations that are hidden from a place, at azimuths 2 pi i / kHorizonAzimuths clockwise from
// north: all below an elevation above the level, linear between azimuths; and what hangs higher,
// such as the crown of a tree, from a low to a high elevation, at the nearest azimuth. Equal:
// nothing hangs there.  [rad]
struct LandHorizon {
  std::array<float, kHorizonAzimuths> elevation_rad{}, lid_low_rad{}, lid_high_rad{};
  [[nodiscard]] double at(double azimuth_rad) const;
  // Returns the fraction of a small disk, such as the sun's, that is not hidden.
  [[nodiscard]] double seen_of_disk(double azimuth_rad, double disk_rad, double radius_rad) const;
  // Returns the index of the nearest azimuth.
  [[nodiscard]] static std::uint32_t nearest(double azimuth_rad);
};

// Land of one material that lies in one way and has one horizon: its temperature is one.
struct LandKind {
  std::uint32_t material = 0;  // of the land's cover
  std::uint32_t horizon = 0;   // of LandKinds::horizon
  bool object = false;         // a face of an object
  Vec<Enu> normal{0, 0, 1};
};

// A part of what is at one place.
struct KindShare {
  std::uint32_t kind;
  float share;
};

// The land at one place.
struct LandMix {
  std::vector<float> fraction;  // [material] not negative, adds up to 1
  std::vector<KindShare> kind;  // positive, adds up to 1
};

// A place that stands for none of the kinds: with the kinds that are taken for it.
struct HeldOutPlace {
  std::uint32_t material = 0;
  bool object = false;  // a face of an object
  Vec<Enu> normal{0, 0, 1};
  LandHorizon horizon;
  std::vector<KindShare> mix;  // adds up to 1
};

// The kinds of land around a target, and which of them stand for a place. Kinds of a material whose
// temperature is computed are its horizons with a level place and four slopes each; and, for the
// faces of objects, eight roofs and sixteen walls more under a free horizon. A place is the mean of
// a few of them, so that the absorbed sunlight of a slope is exact as long as all of them are lit.
// A material whose temperature is stated has one kind.
//
// Horizons are known in squares around the target, each twice as wide as the one within it.
// The numbers are a value: a heat job makes them (kinds/make_land_kinds.h), and views take them.
struct LandKinds {
  // A square of cells around the origin of the land's local frame, row by row from the south.
  struct Square {
    double cell_m = 0;
    std::uint32_t cells = 0;            // along each side
    std::vector<std::uint8_t> horizon;  // [row][column]
  };
  std::uint32_t materials = 0;
  std::vector<bool> computed;        // [material]
  std::vector<bool> on_objects;      // [material] also has kinds for the faces of objects
  std::vector<LandHorizon> horizon;  // [0] is free
  // [material x horizons + horizon] The horizon whose kinds stand for it: itself where the material
  // has that horizon, else the one most like it that it has.
  std::vector<std::uint8_t> stand_in;
  std::vector<Square> square;  // from the narrowest on
  std::vector<LandKind> kind;  // as index_kinds() numbers them
  std::vector<HeldOutPlace> held_out;

  // Writes `kind` and what at() needs, from the members above. Without stand_in every material has
  // all horizons.
  void index_kinds();

  // Appends the kinds of a place, with shares whose sum is that of the fractions.
  //   fraction  [material]
  //   object    a face of an object: its horizon is taken as free
  void at(double x_m, double y_m, Vec<Enu> normal, bool object, std::span<const float> fraction,
          std::vector<KindShare>& out) const;
  // Finds the kinds likewise, of one material with a horizon.
  void at(std::uint32_t material, std::uint32_t horizon, Vec<Enu> normal, bool object, float share,
          std::vector<KindShare>& out) const;
  // Returns the kind that is level under the freest horizon of a material.
  [[nodiscard]] std::uint32_t level_of(std::uint32_t material) const {
    return first_ground_[material * horizon.size()];
  }
  // Returns the horizon of a place; beyond all squares that of the nearest cell.
  [[nodiscard]] std::uint32_t horizon_at(double x_m, double y_m) const;

 private:
  std::vector<std::uint32_t> first_ground_;  // [material x horizons + horizon]
  std::vector<std::uint32_t> first_object_;  // [material]
};

}  // namespace irsig
