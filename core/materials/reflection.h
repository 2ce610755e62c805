#pragma once

namespace irsig {

// The geometry of one reflection at a facet: cosines to the facet's normal of the two directions
// and of their half vector h. As transport holds it (Reflection) and as the models compute with it
// (ReflectionGeometry); cos_i belongs to the light, cos_o to the sensor's side.
struct Reflection {
  float cos_i, cos_o;
  float cos_h;
  float sin2_h;  // the same angle from the half vector's tangential part: 1 - cos_h^2 would cancel
                 // where lobes are 1e-4 wide
  float cos_d;   // of the half vector, to either direction
};

struct ReflectionGeometry {
  double cos_i, cos_o, cos_h, sin2_h, cos_d;
};

// All reflections whose cosines lie between these, and whose half vector has a slope tan^2 of at
// least tan2_h_min.
struct ReflectionRange {
  double cos_i_min, cos_o_min, tan2_h_min;
  double cos_i_max = 1, cos_o_max = 1;

  // Returns the least cos_d, from cos_d cos_h = (cos_i + cos_o) / 2.
  [[nodiscard]] double cos_d_min() const { return 0.5 * (cos_i_min + cos_o_min); }
};

[[nodiscard]] inline ReflectionGeometry widen(const Reflection& r) {
  return {r.cos_i, r.cos_o, r.cos_h, r.sin2_h, r.cos_d};
}

// Returns the same light path in the opposite direction.
[[nodiscard]] inline ReflectionGeometry reversed(const ReflectionGeometry& g) {
  return {g.cos_o, g.cos_i, g.cos_h, g.sin2_h, g.cos_d};
}

}  // namespace irsig
