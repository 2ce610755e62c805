#pragma once

#include <cstdint>
#include <vector>

namespace irsig {

// A sphere at rest: x, y in [0, cell), z up from the plate.
struct SettledSphere {
  double x_m, y_m, z_m, radius_m;
};

// Spheres dropped one after the other onto a plate, each of which falls, rolls down over those
// before it and comes to rest: drop and roll, without friction, rebound or rearrangement.
// [visscher1972] The plate is a periodic square cell, so that copies of it fit together and nothing
// leans on walls.
//
// A sphere's descent is followed in steps down, each followed by moves out of the spheres that it
// then overlaps; it rests when even a step of 1/500 of its radius does not take it lower. Spheres
// overlap by less than 1 % of the smaller radius (tests/unit/particles_test.cpp).
class SettlingBed {
 public:
  // cell_m: at least 4 times the largest diameter.
  SettlingBed(double cell_m, double largest_radius_m);

  // Drops a sphere from above (x, y) and adds it where it comes to rest.
  SettledSphere drop(double x_m, double y_m, double radius_m);

  [[nodiscard]] const std::vector<SettledSphere>& spheres() const { return sphere_; }
  // Returns the largest overlap of two spheres, as a fraction of the smaller radius.
  [[nodiscard]] double largest_overlap() const { return largest_overlap_; }

 private:
  [[nodiscard]] std::size_t column(double x_m, double y_m) const;
  // Spheres within `reach` of (x, y), across.
  void gather(double x_m, double y_m, double reach_m);
  // Moves a sphere out of its neighbours. Returns false if it still overlaps one.
  [[nodiscard]] bool push_out(SettledSphere& s) const;
  void roll(SettledSphere& s);

  double cell_m_, largest_radius_m_;
  std::size_t columns_;  // along one side
  std::vector<std::vector<std::uint32_t>> in_column_;
  std::vector<SettledSphere> sphere_;
  std::vector<SettledSphere> near_;  // relative to no cell border: the nearest images
  double largest_overlap_ = 0;
};

}  // namespace irsig
