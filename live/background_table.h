#pragma once

#include <vector>

#include "live/place_light.h"

namespace irsig {

// Radiance of the background behind target and land, by the z of the direction (PlaceLight).
class BackgroundTable {
 public:
  // table: outlives this.
  BackgroundTable(const std::vector<float>& table, double horizon_z)
      : table_(table), horizon_(static_cast<float>(horizon_z)) {}

  // Returns the mean over directions between two z. [W/(m2 sr)]
  [[nodiscard]] float mean(float upper_z, float lower_z) const;

 private:
  [[nodiscard]] float at(float z, bool above) const;

  const std::vector<float>& table_;
  float horizon_;
};

}  // namespace irsig
