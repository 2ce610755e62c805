#pragma once

#include <optional>

#include "core/geo/frames.h"
#include "core/land/height_tile.h"

namespace irsig {

// The point where a ray passes the surface of a tile.
struct Crossing {
  double t;
  bool inset;
  int column, row;
  LandTriangle triangle;
};

// Part of a tile that another one replaces.
struct HeightInset {
  const HeightTile* tile;
  CellBlock cells;  // of the tile around it
};

// A ray over one tile, in units of its cells along x and y: vertex (i, j) is at (i, j). z is in
// metres, t in lengths of the ray's direction. A bent ray has z = z_ + t dz_ - t^2 curve_.
class HeightWalk {
 public:
  //   bend_per_m  HeightField::first_hit
  HeightWalk(const HeightTile& tile, Vec<Enu> origin_m, Vec<Enu> direction, double bend_per_m = 0);

  // Shortens [begin, end] to the part above or below the tile; false: there is none.
  [[nodiscard]] bool clip(double& begin, double& end) const;

  // Returns the ray's height above the tile's surface at t, where the ray is within the tile's map.
  [[nodiscard]] double clearance_m(double t) const;

  // Returns the first point of [begin, end], all of it within the tile's map, where the ray is not
  // on its side of the surface: above it for side 1, below it for side -1. On the surface itself it
  // is on either side.
  //   starts_above  true: at begin the ray is known to be above the surface, and side is 1. Where
  //                 it rises more steeply than the land it needs no look at heights.
  [[nodiscard]] std::optional<Crossing> first_crossing(double begin, double end, double side,
                                                       const HeightInset* inset,
                                                       bool starts_above = false);

 private:
  struct Exit {
    double t;
    bool along_x;  // the ray leaves a block through its west or east side
  };
  [[nodiscard]] Exit exit_of(const CellBlock& block) const;
  [[nodiscard]] CellBlock block_at(int level) const;
  [[nodiscard]] int column_at(double t, const CellBlock& within) const;
  [[nodiscard]] int row_at(double t, const CellBlock& within) const;
  void place_at(double t, const CellBlock& within);
  [[nodiscard]] bool clear_of(const CellBlock& block, int level, double t_exit);
  [[nodiscard]] bool outclimbs(const CellBlock& block, int level, double t_exit) const;
  [[nodiscard]] std::optional<Crossing> cross_cell(double t_exit) const;
  [[nodiscard]] bool advance(const CellBlock& from, const Exit& exit);
  [[nodiscard]] double clearance_m(double t, LandTriangle triangle) const;
  [[nodiscard]] double z_m(double t) const { return z_ + t * (dz_ - t * curve_); }

  const HeightTile& tile_;
  Vec<Enu> origin_m_, direction_;  // in metres, for the inset's walk
  double bend_per_m_;
  double x_, y_, z_, dx_, dy_, dz_, curve_, across_, inverse_dx_, inverse_dy_, inverse_dz_;
  double side_ = 1, t_ = 0;
  int column_ = 0, row_ = 0;
};

}  // namespace irsig
