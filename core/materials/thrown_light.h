#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace irsig {

class Material;

// How bright the light is that a surface throws on: of light from one direction the shares of what
// is reflected, by radiance. Most of what a glossy surface reflects is in its lobe; as bright as it
// can be at most, far off at grazing angles, is next to nothing of it.
class ThrownLight {
 public:
  struct Class {
    double
        per_sr;  // radiance per irradiance across the light: brdf x cos_i, the largest of the class
    double share;  // of the reflected flux
  };
  // Classes are made from directions: the share that none of these may have met (95 %).
  [[nodiscard]] static double not_met();

  ThrownLight() = default;
  explicit ThrownLight(const Material& material);

  // From bright to dark; shares add up to 1, or there is none.
  [[nodiscard]] std::span<const Class> of(double cos_i) const;

 private:
  static constexpr std::size_t kCells = 32;  // of sqrt(cos_i)
  std::vector<std::vector<Class>> of_cell_;
};

}  // namespace irsig
